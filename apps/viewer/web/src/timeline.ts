/** Play, pause and the slider over recorded frames. */

import { element, icon, iconButton, setText } from "./dom";
import { fixed } from "./numbers";
import type { RecordedFrame } from "./recording";

const SPEEDS = [0.05, 0.1, 0.25, 0.5, 1, 2, 4];
const STATIC_RATE = 10; // frames a second where no time passes
const LONGEST_REST = 0.6; // [s] on the last frame before it starts anew

export class Timeline {
  readonly root: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly words = element("div", { class: "timeline-words tabular", data: "timeline-words" });
  private readonly playButton: HTMLButtonElement;
  private readonly starts: number[]; // [s] of playing at which each frame is shown, at speed 1
  private readonly whole: number; // [s]
  private readonly inTime: boolean;
  private speed = 1;
  private playing = false;
  private clock = 0; // [s] of playing, at speed 1
  private last = 0; // [ms]
  index = 0;

  constructor(
    private readonly frames: RecordedFrame[],
    private readonly shown: (index: number) => void,
    share: () => void,
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
      "aria-label": "frame",
      data: "timeline",
      on: { input: () => this.seek(Number(this.slider.value)) },
    });
    this.playButton = iconButton("play", "Play (Space)", () => this.toggle());
    const speed = element("select", { "aria-label": "speed", data: "speed", title: "speed" });
    speed.append(...SPEEDS.map((s) => element("option", { value: String(s), selected: s === 1 }, `${s}×`)));
    speed.addEventListener("change", () => (this.speed = Number(speed.value)));
    this.root = element(
      "footer",
      { class: "head-up timeline-bar", data: "timeline-bar" },
      this.playButton,
      this.slider,
      this.words,
      speed,
      iconButton("link", "Copy a link to this view", share),
    );
    if (frames.length === 1) this.slider.disabled = this.playButton.disabled = speed.disabled = true;
    this.describe();
  }

  get isPlaying(): boolean {
    return this.playing;
  }

  toggle(): void {
    this.setPlaying(!this.playing);
  }

  setPlaying(playing: boolean): void {
    if (this.frames.length === 1) return;
    this.playing = playing;
    this.last = performance.now();
    if (playing && this.index === this.frames.length - 1) this.clock = 0;
    this.playButton.replaceChildren(icon(playing ? "pause" : "play"));
    this.playButton.title = playing ? "Pause (Space)" : "Play (Space)";
  }

  seek(index: number): void {
    this.index = Math.min(Math.max(index, 0), this.frames.length - 1);
    this.clock = this.starts[this.index];
    this.describe();
    this.shown(this.index);
  }

  /** Once per drawn frame of the page. */
  tick(): void {
    if (!this.playing) return;
    const now = performance.now();
    this.clock = (this.clock + ((now - this.last) / 1000) * this.speed) % this.whole;
    this.last = now;
    let index = this.clock >= this.starts[this.index] ? this.index : 0;
    while (index + 1 < this.starts.length && this.starts[index + 1] <= this.clock) ++index;
    if (index === this.index) return;
    this.index = index;
    this.describe();
    this.shown(index);
  }

  private describe(): void {
    const frame = this.frames[this.index];
    const last = this.frames[this.frames.length - 1];
    const width = String(last.number).length;
    const number = String(frame.number).padStart(width, "\u2007");
    const decimals = this.inTime ? Math.min(6, Math.max(2, 2 - Math.floor(Math.log10(last.time)))) : 0;
    const place = this.inTime ? `${fixed(frame.time, decimals)} s` : `load ${fixed(frame.load, 3)}`;
    setText(this.words, `frame ${number} of ${last.number} · ${place}`);
    this.slider.value = String(this.index);
    this.slider.setAttribute("aria-valuetext", this.words.textContent ?? "");
  }
}
