/** Keys that all pages share, and which keys belong to the control that has the focus. */

import type { Orbit } from "./orbit";

/** The key as it is listed: capitals, as with caps lock, are small letters. */
export function keyOf(event: KeyboardEvent): string {
  return event.key.length === 1 ? event.key.toLowerCase() : event.key;
}

const OF_SLIDERS = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "PageUp", "PageDown"];

/** Whether the focused control takes this key itself: letters in a field, Space on a button, arrows on a slider. */
export function belongsToControl(event: KeyboardEvent): boolean {
  const { target, key } = event;
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement) {
    if (target.type === "range") return OF_SLIDERS.includes(key);
    if (target.type === "checkbox") return key === " ";
    return key !== "Escape";
  }
  if (target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement) return key !== "Escape";
  return target.closest("button, a[href], summary") !== null && (key === " " || key === "Enter");
}

const TURN = 36; // as many pixels of the mouse
const ZOOM = 1.15;
const STEPS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** The way that an arrow key points, in the window; null for another key. */
export const arrowOf = (event: KeyboardEvent): [number, number] | null => STEPS[event.key] ?? null;

/** Shift and an arrow turn the camera (in 2D they move it), + and - come nearer and go away. */
export function movesCamera(event: KeyboardEvent, orbit: Orbit): boolean {
  const arrow = arrowOf(event);
  if (arrow && event.shiftKey) orbit.turn(TURN * arrow[0], TURN * arrow[1]);
  else if (event.key === "+" || event.key === "=") orbit.zoom(1 / ZOOM);
  else if (event.key === "-" || event.key === "\u2212") orbit.zoom(ZOOM);
  else return false;
  return true;
}

/** Entries of the help for these keys. */
export const CAMERA_KEYS: [string, string][] = [["Shift and arrows, + −", "rotate the camera, zoom"]];
