/** Play, pause and the slider over recorded frames; of vibrations over their modes, which swing. */

import { element, icon, iconButton, setText } from "./dom";
import { type Mode, modeWords, swingAt, Tone } from "./modes";
import { fixed, plain } from "./numbers";
import type { RecordedFrame } from "./recording";

const SPEEDS = [0.05, 0.1, 0.25, 0.5, 1, 2, 4];
const STATIC_RATE = 10; // frames a second where no time passes
const LONGEST_REST = 0.6; // [s] on the last frame before it starts anew

export interface TimelineEvents {
  /** `swing`: how much of a mode's shape is to be seen, 1 to -1. */
  shown(index: number, swing: number): void;
  share(): void;
  takenUp: (() => void) | null; // null: the page cannot play with the scene
}

export class Timeline {
  readonly root: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly words = element("div", { class: "timeline-words tabular", data: "timeline-words" });
  private readonly playButton: HTMLButtonElement;
  private readonly soundButton: HTMLButtonElement;
  private readonly starts: number[]; // [s] of playing at which each frame is shown, at speed 1
  private readonly whole: number; // [s]
  private readonly inTime: boolean;
  private readonly tone = new Tone();
  private isSounding = false;
  private speed = 1;
  private playing = false;
  private clock = 0; // [s] of playing, at speed 1
  private last = 0; // [ms]
  index = 0;

  constructor(
    private readonly frames: RecordedFrame[],
    private readonly modes: (Mode | null)[], // by frame; empty: no vibrations
    private readonly events: TimelineEvents,
  ) {
    const first = frames[0].time;
    this.inTime = frames.length > 1 && frames.every((frame, i) => i === 0 || frame.time > frames[i - 1].time);
    this.starts = frames.map((frame, i) => (this.inTime ? frame.time - first : i / STATIC_RATE));
    const end = this.starts[frames.length - 1];
    this.whole = end + Math.min(LONGEST_REST, Math.max(0.25 * end, 1 / STATIC_RATE));
    this.slider = element("input", {
      type: "range",
      class: "timeline",
      min: "0",
      max: String(frames.length - 1),
      value: "0",
      "aria-label": this.showsModes ? "mode" : "frame",
      data: "timeline",
      on: { input: () => this.seek(Number(this.slider.value)) },
    });
    this.playButton = iconButton("play", "Play (Space)", () => this.toggle());
    this.soundButton = iconButton("sound", "Play the tone of the mode", () => this.setSound(!this.isSounding));
    this.soundButton.setAttribute("aria-pressed", "false");
    this.soundButton.hidden = !modes.some((mode) => Tone.canBeHeard(mode));
    const speed = element("select", { "aria-label": "speed", data: "speed", title: "speed" });
    speed.append(...SPEEDS.map((s) => element("option", { value: String(s), selected: s === 1 }, `${s}×`)));
    speed.addEventListener("change", () => (this.speed = Number(speed.value)));
    this.root = element(
      "footer",
      { class: "head-up timeline-bar", data: "timeline-bar" },
      this.playButton,
      ...(events.takenUp ? [iconButton("hand", "Continue the simulation from here (t)", events.takenUp)] : []),
      this.slider,
      this.words,
      this.soundButton,
      speed,
      iconButton("link", "Copy a link to this view", () => events.share()),
    );
    if (frames.length === 1) this.slider.disabled = this.playButton.disabled = speed.disabled = true;
    this.describe();
  }

  get showsModes(): boolean {
    return this.modes.length > 0;
  }

  get isPlaying(): boolean {
    return this.playing;
  }

  /** [Hz] of the tone that is heard; null: none. */
  get tonePlayed(): number | null {
    return this.isSounding ? this.tone.frequency : null;
  }

  toggle(): void {
    this.setPlaying(!this.playing);
  }

  setPlaying(playing: boolean): void {
    if (this.frames.length === 1) return;
    this.playing = playing;
    this.last = performance.now();
    if (playing && (this.showsModes || this.index === this.frames.length - 1)) this.clock = 0;
    this.playButton.replaceChildren(icon(playing ? "pause" : "play"));
    this.playButton.title = playing ? "Pause (Space)" : "Play (Space)";
    this.playButton.setAttribute("aria-label", this.playButton.title);
  }

  private setSound(isOn: boolean): void {
    this.isSounding = isOn;
    this.soundButton.setAttribute("aria-pressed", String(isOn));
    this.tone.play(isOn ? (this.modes[this.index] ?? null) : null);
  }

  seek(index: number): void {
    this.index = Math.min(Math.max(index, 0), this.frames.length - 1);
    this.clock = this.showsModes ? 0 : this.starts[this.index];
    this.describe();
    if (this.isSounding) this.setSound(true);
    this.events.shown(this.index, 1);
  }

  /** Once per drawn frame of the page. */
  tick(): void {
    if (!this.playing) return;
    const now = performance.now();
    const clock = this.clock + ((now - this.last) / 1000) * this.speed;
    this.last = now;
    if (this.showsModes) {
      this.clock = clock;
      this.events.shown(this.index, this.modes[this.index] ? swingAt(clock) : 1);
      return;
    }
    this.clock = clock % this.whole;
    let index = this.clock >= this.starts[this.index] ? this.index : 0;
    while (index + 1 < this.starts.length && this.starts[index + 1] <= this.clock) ++index;
    if (index === this.index) return;
    this.index = index;
    this.describe();
    this.events.shown(index, 1);
  }

  private describe(): void {
    setText(this.words, this.showsModes ? this.wordsOfMode() : this.wordsOfFrame());
    this.slider.value = String(this.index);
    this.slider.setAttribute("aria-valuetext", this.words.textContent ?? "");
  }

  private wordsOfMode(): string {
    return modeWords(this.modes[this.index], this.modes.filter((mode) => mode !== null).length);
  }

  private wordsOfFrame(): string {
    const frame = this.frames[this.index];
    const last = this.frames[this.frames.length - 1];
    const width = String(last.number).length;
    const number = String(frame.number).padStart(width, "\u2007");
    const decimals = this.inTime ? Math.min(6, Math.max(2, 2 - Math.floor(Math.log10(last.time)))) : 0;
    const place = this.inTime ? `${fixed(frame.time, decimals)} s` : `load ${plain(frame.load)}`;
    return `frame ${number} of ${last.number} · ${place}`;
  }
}
