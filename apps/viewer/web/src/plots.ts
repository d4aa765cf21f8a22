/** The column of plots beside a recorded scene: the probed place first, then what the report holds. */

import { Chart, type Series } from "./charts";
import { element } from "./dom";
import { LineChart } from "./line_chart";
import type { LineValues } from "./line_probe";
import type { RecordedValues } from "./recorded_values";
import { axisWords, curvesOf, type Report, timeAxis, type TimeAxis } from "./report";

const HEIGHT = 132;

export class Plots {
  readonly root = element("aside", { class: "card plots", data: "plots", "aria-label": "plots" });
  private readonly probePlace = element("div", { data: "probe" });
  private readonly hint = element(
    "p",
    { class: "hint" },
    "Click the body, or press Enter, to plot the values of that point over the frames.",
  );
  private readonly linePlace = element("div", { data: "line-plot" });
  private readonly lineChart = new LineChart(this.linePlace, HEIGHT);
  private probeCharts: Chart[] = [];
  private readonly reportCharts: Chart[] = [];
  private readonly axis: TimeAxis;
  private marked = 0;

  constructor(
    private readonly values: RecordedValues,
    report: Report | null,
    private readonly seek: (index: number) => void,
  ) {
    const { frames } = values.recording;
    this.axis = report?.frames.some((frame) => frame.mode) ? timeAxis(report.frames) : timeAxis(frames);
    this.root.append(this.linePlace, this.probePlace);
    this.probePlace.append(this.hint);
    if (!report) return;
    const times = report.frames.map((frame, i) => this.axis.of(frame, i));
    const jump = (index: number) => {
      const later = frames.findIndex((frame) => frame.number >= index);
      seek(later < 0 ? frames.length - 1 : later);
    };
    for (const { title, quantity, scale, series, values: rows, points = false } of curvesOf(report, this.dimension)) {
      const chart = this.chart(title, quantity, series, jump, points, scale);
      chart.set(times, rows);
      this.reportCharts.push(chart);
      this.root.append(chart.root);
    }
  }

  private get dimension(): 2 | 3 {
    return this.values.recording.header.dimension;
  }

  private chart(
    title: string,
    quantity: string,
    series: Series[],
    clicked: (index: number) => void,
    points = false,
    scale = 0,
  ): Chart {
    const axis = axisWords(this.axis);
    return new Chart({ title, quantity, series, height: HEIGHT, legend: true, axis, points, scale, clicked });
  }

  get isEmpty(): boolean {
    return this.reportCharts.length === 0 && this.probeCharts.length === 0;
  }

  /** Curves of one vertex: its displacement, and the field that is shown. `vertex` null: none. */
  probe(vertex: number | null, field: number): void {
    this.probeCharts.forEach((chart) => chart.destroy());
    this.probeCharts = [];
    this.probePlace.replaceChildren();
    if (vertex === null) {
      this.probePlace.append(this.hint);
      return;
    }
    const { frames } = this.values.recording;
    const flat = this.values.recording.header.dimension === 2;
    const times = frames.map((frame, i) => this.axis.of(frame, i));
    const moved = frames.map((_, i) => this.values.displacement(i, vertex));
    const labels = flat ? ["x", "y", "length"] : ["x", "y", "z", "length"];
    const rows = labels.map((label) => moved.map((u) => u["xyz".indexOf(label) < 0 ? 3 : "xyz".indexOf(label)]));
    const add = (title: string, quantity: string, series: Series[], values: number[][], scale: number) => {
      const chart = this.chart(title, quantity, series, this.seek, false, scale);
      chart.set(times, values);
      this.probeCharts.push(chart);
      this.probePlace.append(chart.root);
    };
    add(
      `Displacement of vertex ${vertex}`,
      "displacement",
      labels.map((label) => ({ label, unit: "m" })),
      rows,
      this.values.largestDisplacement,
    );
    if (field >= 0 && this.values.fields[field].group !== "displacement") {
      const { label, unit } = this.values.fields[field];
      const title = `${label} of vertex ${vertex}`;
      const [low, high] = this.values.range(field);
      const curve = frames.map((_, i) => this.values.value(i, field, vertex));
      add(
        title[0].toUpperCase() + title.slice(1),
        label,
        [{ label, unit }],
        [curve],
        Math.max(Math.abs(low), Math.abs(high)),
      );
    }
    this.mark(this.marked);
  }

  /** The field along a line, at the frame that is shown; null: there is no line. */
  showLine(line: LineValues | null, field: number): void {
    if (line === null || field < 0) return this.lineChart.remove();
    const [low, high] = this.values.range(field);
    this.lineChart.show(line, this.values.fields[field], Math.max(Math.abs(low), Math.abs(high)));
  }

  /** The time that is shown. */
  mark(index: number): void {
    this.marked = index;
    const time = this.axis.of(this.values.recording.frames[index], index);
    [...this.probeCharts, ...this.reportCharts].forEach((chart) => chart.mark(time));
  }

  redraw(): void {
    this.lineChart.redraw();
    [...this.probeCharts, ...this.reportCharts].forEach((chart) => chart.redraw());
  }
}
