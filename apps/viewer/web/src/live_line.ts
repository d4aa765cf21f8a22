/** The line of a live scene along which the shown field is plotted, frame by frame. */

import * as THREE from "three";
import { element } from "./dom";
import { LineChart } from "./line_chart";
import { valuesAlong, type LineValues } from "./line_probe";
import { placeOf, type Hit } from "./picking";
import type { Field, Frame, Topology } from "./protocol";
import { joined } from "./viewport";

const HEIGHT = 110;
const PAUSE = 100; // [ms] between two plots of a moving scene

export class LiveLine {
  readonly root = element("div", { class: "card line-card", data: "line-plot", hidden: true });
  values: LineValues | null = null;
  private readonly chart = new LineChart(this.root, HEIGHT);
  private ends: Hit[] | null = null; // null: no line is asked for
  private topology: Topology | null = null;
  private cells: Uint32Array | null = null; // cells of all parts, once there was a line
  private flat = false;
  private placed = -1; // frame whose ends are drawn
  private plotted = { number: -1, field: -1, at: 0 }; // frame and field of the plot, and when it was made [ms]

  setScene(topology: Topology, flat: boolean): void {
    this.topology = topology;
    this.flat = flat;
    this.cells = null;
    this.clear();
  }

  private clear(): void {
    this.ends = null;
    this.root.hidden = true;
    this.chart.remove();
  }

  get isOn(): boolean {
    return this.ends !== null;
  }

  /** Whether the next click is an end of the line. */
  get isAsking(): boolean {
    return this.ends !== null && this.ends.length < 2;
  }

  /** Switches the line on or off; tells in words what is to be done next. */
  toggle(): string {
    if (this.isOn) {
      this.clear();
      return "";
    }
    this.cells ??= joined(this.flat ? this.topology!.triangles : this.topology!.tetrahedra);
    if (this.cells.length === 0) return "This scene is too large for a plot along a line; `resilin run` records it.";
    this.ends = [];
    this.placed = this.plotted.number = -1;
    return "Click where the line begins.";
  }

  /** True when another end is needed. */
  add(hit: Hit): boolean {
    this.ends!.push(hit);
    this.placed = this.plotted.number = -1;
    return this.isAsking;
  }

  /** The ends as the frame has them; null: the frame was here before. */
  update(frame: Frame, field: Field | null): THREE.Vector3[] | null {
    const isOfField = this.plotted.field === frame.field;
    const isPlotted = isOfField && this.plotted.number === frame.number;
    if (this.placed === frame.number && isPlotted) return null;
    this.placed = frame.number;
    const ends = this.ends!.map((hit) => placeOf(hit, frame.positions, new THREE.Vector3()));
    const now = performance.now();
    if (isPlotted || (isOfField && this.plotted.number >= 0 && now - this.plotted.at < PAUSE)) return ends;
    this.plotted = { number: frame.number, field: frame.field, at: now };
    this.root.hidden = ends.length < 2 || field === null;
    if (this.root.hidden) return ends;
    this.values = valuesAlong(this.cells!, this.flat ? 3 : 4, frame, ends[0].toArray(), ends[1].toArray());
    this.chart.show(this.values, field!, field!.scale ?? 0);
    return ends;
  }

  redraw(): void {
    this.chart.redraw();
  }
}
