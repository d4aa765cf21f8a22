/** Mouse, pen and fingers on the canvas: a tool may take a press; all else moves the camera. */

import type { Orbit } from "./orbit";

export interface Place {
  x: number; // [pixels] in the canvas
  y: number;
}

export interface GestureEvents {
  /** True: the tool takes this press, and `drag` and `release` follow. */
  press(at: Place): boolean;
  drag(at: Place): void;
  release(): void;
  /** A press that neither moved nor was taken. */
  click(at: Place): void;
  hover(at: Place | null): void;
  cameraMoved(): void;
}

const CLICK_REACH = 5; // pixels that a click may wander
const WHEEL = 0.0014;

export class Gestures {
  private readonly pointers = new Map<number, Place>();
  private taken: number | null = null; // pointer that a tool holds
  private pressed: Place | null = null; // begin of what may become a click
  private button = 0;
  private shift = false;

  constructor(
    private readonly canvas: HTMLElement,
    private readonly orbit: () => Orbit,
    private readonly events: GestureEvents,
  ) {
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", (event) => this.up(event));
    canvas.addEventListener("pointerleave", () => this.pointers.size === 0 && events.hover(null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const lines = event.deltaMode === 1 ? 18 : 1;
        this.orbit().zoom(Math.exp(WHEEL * lines * Math.min(Math.max(event.deltaY, -240), 240)));
        events.cameraMoved();
      },
      { passive: false },
    );
  }

  /** Lets go of what a tool holds, as when the body is taken from it. */
  cancel(): void {
    this.taken = null;
  }

  private place(event: PointerEvent): Place {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private down(event: PointerEvent): void {
    const at = this.place(event);
    // A pointer that a script made up, or that is gone already, cannot be captured; nothing is lost then.
    if (event.isTrusted) this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, at);
    if (this.pointers.size === 2) {
      this.endTool(); // two fingers are for the camera
      this.pressed = null;
      return;
    }
    this.button = event.button;
    this.shift = event.shiftKey || event.ctrlKey || event.metaKey;
    this.pressed = at;
    if (event.button !== 0 || this.shift || !this.events.press(at)) return;
    this.taken = event.pointerId;
    this.pressed = null;
  }

  private move(event: PointerEvent): void {
    const at = this.place(event);
    const last = this.pointers.get(event.pointerId);
    if (!last) return this.events.hover(event.pointerType === "touch" ? null : at);
    if (this.taken === event.pointerId) {
      this.pointers.set(event.pointerId, at);
      return this.events.drag(at);
    }
    if (this.pressed && Math.hypot(at.x - this.pressed.x, at.y - this.pressed.y) < CLICK_REACH) return;
    this.pressed = null;
    const orbit = this.orbit();
    if (this.pointers.size >= 2) this.pinch(event.pointerId, last, at);
    else if (this.button === 1 || this.shift) orbit.move(at.x - last.x, at.y - last.y);
    else orbit.turn(at.x - last.x, at.y - last.y);
    this.pointers.set(event.pointerId, at);
    this.events.cameraMoved();
  }

  /** Two fingers: their middle moves the scene, their distance brings it nearer. */
  private pinch(moving: number, last: Place, at: Place): void {
    const other = [...this.pointers].find(([id]) => id !== moving)![1];
    const before = Math.hypot(last.x - other.x, last.y - other.y);
    const after = Math.hypot(at.x - other.x, at.y - other.y);
    this.orbit().move((at.x - last.x) / 2, (at.y - last.y) / 2);
    if (before > 0 && after > 0) this.orbit().zoom(before / after);
  }

  private up(event: PointerEvent): void {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.taken === event.pointerId) return this.endTool();
    if (this.pressed && event.type === "pointerup" && event.button === 0) this.events.click(this.pressed);
    this.pressed = null;
  }

  private endTool(): void {
    if (this.taken === null) return;
    this.taken = null;
    this.events.release();
  }
}
