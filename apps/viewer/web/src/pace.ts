/** How long frames take, and the light drawing that is chosen when they take too long: as on machines without a GPU. */

export type DrawingChoice = "auto" | "full" | "light";

const SLOW = 100; // [ms] between two frames
const PATIENCE = 4; // slow frames in a row
const LONGEST = 2000; // [ms]; longer gaps are those of a hidden page
const LIGHT_PIXELS = 0.6; // for each pixel of the window, along each side
export const FULL_PIXELS = 2;

export class Pace {
  choice: DrawingChoice = "auto";
  private isSlow = false;
  private slowFrames = 0;
  private lastDrawn: number | null = null; // [ms] when the browser's frame before began; null: nothing was drawn in it

  /** `changed`: with the pixels for each of the window's. */
  constructor(private readonly changed: (isLight: boolean, pixels: number) => void) {}

  get isLight(): boolean {
    return this.choice === "light" || (this.choice === "auto" && this.isSlow);
  }

  /** For each of the window's, along each side. */
  get pixels(): number {
    return this.isLight ? LIGHT_PIXELS : FULL_PIXELS;
  }

  choose(choice: DrawingChoice): void {
    this.choice = choice;
    if (choice === "auto") this.isSlow = false; // it is measured anew
    this.slowFrames = 0;
    this.tell();
  }

  /** Once per frame of the browser; `drawn`: something was drawn in it. What counts is the time until the next one. */
  frame(now: number, drawn: boolean): void {
    const took = this.lastDrawn === null ? 0 : now - this.lastDrawn;
    this.lastDrawn = drawn && !document.hidden ? now : null;
    if (took === 0 || took > LONGEST) return;
    this.slowFrames = took > SLOW ? this.slowFrames + 1 : 0;
    if (this.slowFrames < PATIENCE || this.isSlow || this.choice !== "auto") return;
    this.isSlow = true;
    this.tell();
  }

  private tell(): void {
    document.documentElement.dataset.drawing = this.isLight ? "light" : "full";
    this.changed(this.isLight, this.pixels);
  }
}
