/** A place in the window for those who go by keys: arrows move it, Enter means what lies under it. */

import { element } from "./dom";
import type { Place } from "./gestures";

const STEP = 14; // pixels

export class Crosshair {
  readonly root = element("div", { class: "crosshair", data: "crosshair", hidden: true, "aria-hidden": "true" });
  place: Place = { x: 0, y: 0 };

  get isShown(): boolean {
    return !this.root.hidden;
  }

  show(at: Place): void {
    this.root.hidden = false;
    this.moveTo(at);
  }

  hide(): void {
    this.root.hidden = true;
  }

  move([dx, dy]: [number, number]): void {
    const within = (value: number, end: number) => Math.min(Math.max(value, 0), end);
    this.moveTo({
      x: within(this.place.x + STEP * dx, innerWidth),
      y: within(this.place.y + STEP * dy, innerHeight),
    });
  }

  private moveTo(at: Place): void {
    this.place = at;
    this.root.style.transform = `translate(${at.x}px, ${at.y}px)`;
  }
}
