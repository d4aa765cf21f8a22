/** The view in the address: #frame=12&field=von_mises&camera=..., so that a link shows the same. */

import { COLOR_MAPS, type ColorMap } from "./color_map";
import { ANGLES } from "./revolve";
import type { Pose } from "./orbit";
import type { Look } from "./viewport";

export interface SharedView {
  frame?: number;
  from?: number; // number of the frame from which the recorded scene is played with
  field?: string;
  camera?: Pose;
  look?: Partial<Look>;
  range?: [number, number];
}

const SWITCHES = ["wireframe", "cells", "cut", "cutFlip", "parallel"] as const;

export function writeAddress(view: SharedView): string {
  const parts: string[] = [];
  if (view.frame !== undefined) parts.push(`frame=${view.frame}`);
  if (view.from !== undefined) parts.push(`from=${view.from}`);
  if (view.field) parts.push(`field=${encodeURIComponent(view.field)}`);
  if (view.camera) {
    const { azimuth, elevation, distance, target } = view.camera;
    parts.push(`camera=${[azimuth, elevation, distance, ...target].map((x) => Number(x.toPrecision(6))).join(",")}`);
  }
  const on = SWITCHES.filter((name) => view.look?.[name]);
  if (on.length > 0) parts.push(`show=${on.join(",")}`);
  if (view.look?.cut) parts.push(`cut=${view.look.cutAxis}${view.look.cutAt}`);
  if (view.look?.colorMap && view.look.colorMap !== "viridis") parts.push(`colors=${view.look.colorMap}`);
  if (view.look?.revolve) parts.push(`revolve=${view.look.revolve}`);
  if (view.look?.arrows) parts.push(`arrows=${encodeURIComponent(view.look.arrows)}`);
  if (view.range) parts.push(`range=${view.range.join(",")}`);
  return `#${parts.join("&")}`;
}

/** Reads a view from an address; malformed entries are left out. */
export function readAddress(hash: string): SharedView {
  const words = new URLSearchParams(hash.replace(/^#/, ""));
  const view: SharedView = {};
  const numbers = (name: string) => words.get(name)?.split(",").map(Number) ?? [];
  for (const key of ["frame", "from"] as const) {
    const number = Number(words.get(key) || NaN);
    if (Number.isInteger(number) && number >= 0) view[key] = number;
  }
  const field = words.get("field");
  if (field !== null) view.field = field;
  const camera = numbers("camera");
  if (camera.length === 6 && camera.every(Number.isFinite) && camera[2] > 0) {
    const [azimuth, elevation, distance, x, y, z] = camera;
    view.camera = { azimuth, elevation, distance, target: [x, y, z] };
  }
  const on = words.get("show")?.split(",") ?? [];
  view.look = Object.fromEntries(SWITCHES.map((name) => [name, on.includes(name)]));
  const cut = /^([xyz])([\d.]+)$/.exec(words.get("cut") ?? "");
  if (cut && Number(cut[2]) <= 1) Object.assign(view.look, { cutAxis: cut[1], cutAt: Number(cut[2]) });
  const colors = words.get("colors");
  if (colors !== null && colors in COLOR_MAPS) view.look.colorMap = colors as ColorMap;
  view.look.arrows = words.get("arrows") ?? (on.includes("vectors") ? "displacement" : ""); // as links once had it
  const revolve = Number(words.get("revolve"));
  view.look.revolve = ANGLES.includes(revolve) ? revolve : 0;
  const range = numbers("range");
  if (range.length === 2 && range.every(Number.isFinite) && range[0] < range[1]) view.range = [range[0], range[1]];
  return view;
}

/** The field of this name, or what it is called on the vertices; "" where there is none. */
export function nameOfField(fields: { name: string }[], name: string): string {
  return (
    [name, `nodal_${name}`, `averaged_${name}`].find((known) => fields.some((field) => field.name === known)) ?? ""
  );
}

const REST = 250; // [ms] between two changes of the address

/** Keeps the address of the page in step with the view. */
export class AddressBar {
  private timer = 0;

  /** `view`: what is to be shared now; null: not now. */
  constructor(private readonly view: () => SharedView | null) {}

  changed(): void {
    if (this.timer !== 0) return;
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      this.write();
    }, REST);
  }

  write(): void {
    const view = this.view();
    if (!view) return;
    try {
      history.replaceState(null, "", writeAddress(view));
    } catch {
      // A frame without an address of its own, as in a notebook: nothing to share.
    }
  }
}
