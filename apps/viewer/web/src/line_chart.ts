/** The plot of a field along a line; there is none until a line is shown. */

import { Chart } from "./charts";
import type { LineValues } from "./line_probe";

export class LineChart {
  private chart: Chart | null = null;

  constructor(
    private readonly place: HTMLElement,
    private readonly height: number,
  ) {}

  /** `scale`: of the values in the scene; null: there is no line. */
  show(line: LineValues | null, { label, unit }: { label: string; unit: string }, scale: number): void {
    if (line === null) return this.remove();
    const title = `${label[0].toUpperCase()}${label.slice(1)} along the line`;
    if (this.chart?.title !== title) {
      this.remove();
      this.chart = new Chart({
        title,
        quantity: label,
        series: [{ label, unit }],
        height: this.height,
        legend: true,
        axis: "distance [m]",
        scale,
      });
      this.place.append(this.chart.root);
    }
    this.chart!.set(line.distances, [line.values]);
  }

  remove(): void {
    this.chart?.destroy();
    this.chart = null;
  }

  redraw(): void {
    this.chart?.redraw();
  }
}
