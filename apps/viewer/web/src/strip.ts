/** The last seconds of a live scene: milliseconds of a step, and energies. */

import { Chart, type Series } from "./charts";
import { element } from "./dom";
import { perDepth } from "./numbers";
import type { Status } from "./protocol";

const KEPT = 200; // status messages: about 20 s

export class Strip {
  readonly root: HTMLElement;
  private readonly steps: Chart;
  private energies: Chart;
  private dimension: 2 | 3 = 3;
  private readonly history: Status[] = [];

  constructor() {
    this.steps = chart("Time per step", "step", [{ label: "step", unit: "s" }]);
    this.energies = chartOfEnergies(this.dimension);
    this.root = element("div", { class: "card strip", data: "strip" }, this.steps.root, this.energies.root);
  }

  /** Energies of a scene in 2D are those of a metre of depth. */
  setDimension(dimension: 2 | 3): void {
    if (dimension === this.dimension) return;
    this.dimension = dimension;
    this.energies.destroy();
    this.energies = chartOfEnergies(dimension);
    this.root.append(this.energies.root);
  }

  add(status: Status): void {
    const last = this.history[this.history.length - 1];
    if (last && status.time === last.time) return; // paused, or at rest
    if (last && status.time < last.time) this.history.length = 0;
    this.history.push(status);
    if (this.history.length > KEPT) this.history.shift();
    if (this.root.hidden || this.root.offsetParent === null) return;
    const times = this.history.map((s) => s.time);
    this.steps.set(times, [this.history.map((s) => 1e-3 * s.step_ms)]);
    this.energies.set(times, [this.history.map((s) => s.elastic_energy), this.history.map((s) => s.kinetic_energy)]);
  }

  redraw(): void {
    this.steps.redraw();
    this.energies.redraw();
  }
}

function chart(title: string, quantity: string, series: Series[]): Chart {
  return new Chart({ title, series, height: 96, legend: true, axis: "time [s]", quantity });
}

function chartOfEnergies(dimension: 2 | 3): Chart {
  const unit = perDepth("J", dimension);
  return chart("Energy", "energy", [
    { label: "elastic", unit },
    { label: "kinetic", unit },
  ]);
}
