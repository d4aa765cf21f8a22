/** A film of the canvas as it is seen, in the form that the browser writes: WebM, else MP4. */

import { element, iconButton, setText } from "./dom";
import { download } from "./download";

const RATE = 30; // [frames/s]
const LONGEST = 10 * 60; // [s]: a recording lies in memory
const TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];

/** "0:07". */
export function clock(seconds: number): string {
  const whole = Math.floor(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

export class Recorder {
  readonly counter = element("span", { class: "counter tabular", data: "counter", role: "timer", hidden: true });
  readonly button = iconButton("record", "Record a film (v)", () => this.toggle());
  private readonly film = element("canvas", {}); // the scene before the colour of the page
  private running: MediaRecorder | null = null;
  private began = 0; // [ms]

  constructor(
    private readonly scene: HTMLCanvasElement,
    private readonly name: () => string,
    private readonly say: (words: string, mood?: "refused" | "fine") => void,
    private readonly paintOver: (pen: CanvasRenderingContext2D, scale: number) => void = () => {},
  ) {
    this.button.setAttribute("aria-pressed", "false");
  }

  get isRunning(): boolean {
    return this.running !== null;
  }

  toggle(): void {
    if (this.running) this.running.stop();
    else this.start();
  }

  private start(): void {
    const type = typeof MediaRecorder === "undefined" ? undefined : TYPES.find((t) => MediaRecorder.isTypeSupported(t));
    if (type === undefined || !this.film.captureStream)
      return this.say("This browser cannot record films; “resilin film” renders results.");
    this.film.width = this.scene.width & ~1; // codecs want even numbers
    this.film.height = this.scene.height & ~1;
    this.paint();
    const stream = this.film.captureStream(RATE);
    const pieces: Blob[] = [];
    const recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: 8e6 });
    recorder.ondataavailable = ({ data }) => data.size > 0 && pieces.push(data);
    recorder.onerror = () => this.say("The browser has ended the recording.");
    recorder.onstop = () => {
      stream.getTracks().forEach((track) => track.stop());
      this.running = null;
      this.show(false);
      const film = new Blob(pieces, { type });
      if (film.size === 0) return this.say("Nothing was recorded.");
      const file = `${this.name()}.${type.startsWith("video/mp4") ? "mp4" : "webm"}`;
      download(film, file);
      this.say(`Recorded ${file}: ${clock(this.seconds)}, ${(film.size / 1e6).toFixed(1)} MB.`, "fine");
    };
    recorder.start(1000); // in pieces of a second, so that little is lost where it breaks off
    this.running = recorder;
    this.began = performance.now();
    this.show(true);
  }

  private get seconds(): number {
    return (performance.now() - this.began) / 1000;
  }

  private show(isRunning: boolean): void {
    this.counter.hidden = !isRunning;
    this.button.setAttribute("aria-pressed", String(isRunning));
    this.button.title = isRunning ? "End the recording (v)" : "Record a film (v)";
    this.button.setAttribute("aria-label", this.button.title);
  }

  /** To be called for each frame of the window, drawn anew or not: time goes on. */
  frame(): void {
    if (!this.running) return;
    this.paint();
    setText(this.counter, clock(this.seconds));
    if (this.seconds > LONGEST) this.running.stop();
  }

  /** The scene, as large as it fits, before the page's colours. */
  private paint(): void {
    const { width, height } = this.film;
    const pen = this.film.getContext("2d")!;
    const colors = getComputedStyle(document.documentElement);
    const sky = pen.createRadialGradient(width / 2, 0.38 * height, 0, width / 2, 0.38 * height, 0.8 * width);
    sky.addColorStop(0.2, colors.getPropertyValue("--sky-1"));
    sky.addColorStop(1, colors.getPropertyValue("--sky-2"));
    pen.fillStyle = sky;
    pen.fillRect(0, 0, width, height);
    const scale = Math.min(width / this.scene.width, height / this.scene.height);
    const [w, h] = [scale * this.scene.width, scale * this.scene.height];
    pen.drawImage(this.scene, (width - w) / 2, (height - h) / 2, w, h);
    this.paintOver(pen, width / Math.max(this.scene.clientWidth, 1));
  }
}
