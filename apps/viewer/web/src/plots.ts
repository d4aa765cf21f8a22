/** The column of plots beside a recorded scene: the probed place first, then what the report holds. */

import { Chart, type Series } from "./charts";
import { element } from "./dom";
import { LineChart } from "./line_chart";
import type { LineValues } from "./line_probe";
import type { RecordedValues } from "./recorded_values";
import { axisWords, curvesOf, type Curves, type Report, timeAxis, type TimeAxis } from "./report";

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
  private reportCharts: Chart[] = [];
  private readonly reportPlace = element("div", {});
  private curves: Curves[] = [];
  private over: number[] | null = null; // quantity on the horizontal axis, for each frame of the report; null: time
  private readonly axis: TimeAxis;
  private marked = 0;

  constructor(
    private readonly values: RecordedValues,
    private readonly report: Report | null,
    private readonly seek: (index: number) => void,
  ) {
    const { frames } = values.recording;
    this.axis = report?.frames.some((frame) => frame.mode) ? timeAxis(report.frames) : timeAxis(frames);
    this.root.append(this.linePlace, this.probePlace);
    this.probePlace.append(this.hint);
    if (!report) return;
    this.curves = curvesOf(report, this.dimension);
    if (this.curves.length > 0 && !report.frames.some((frame) => frame.mode)) this.root.append(this.axisChoice());
    this.root.append(this.reportPlace);
    this.drawReport(null);
  }

  /** A list of what the report's curves may be drawn over: time, or one of the curves. */
  private axisChoice(): HTMLElement {
    const all = this.curves.flatMap(({ title, series }, c) =>
      series.map(({ label, unit }, s) => ({ c, s, words: series.length > 1 ? `${title}, ${label}` : title, unit })),
    );
    const select = element(
      "select",
      {
        data: "plots-over",
        on: { change: () => this.drawReport(select.value === "" ? null : all[Number(select.value)]) },
      },
      element("option", { value: "" }, this.axis.label),
      ...all.map(({ words }, i) => element("option", { value: String(i) }, words)),
    );
    return element("label", { class: "plots-over" }, "Plot over ", select);
  }

  private drawReport(over: { c: number; s: number; words: string; unit: string } | null): void {
    const { frames } = this.values.recording;
    this.reportCharts.forEach((chart) => chart.destroy());
    this.reportCharts = [];
    this.over = over && this.curves[over.c].values[over.s];
    const times = this.report!.frames.map((frame, i) => this.axis.of(frame, i));
    const jump = (index: number) => {
      const later = frames.findIndex((frame) => frame.number >= index);
      this.seek(later < 0 ? frames.length - 1 : later);
    };
    const axis = over ? (over.unit ? `${over.words} [${over.unit}]` : over.words) : axisWords(this.axis);
    this.curves.forEach(({ title, quantity, scale, series, values: rows, points = false }) => {
      const options = { title, quantity, series, height: HEIGHT, legend: true, axis, points, scale, clicked: jump };
      const chart = new Chart({ ...options, loops: over !== null });
      chart.set(this.over ?? times, rows);
      this.reportCharts.push(chart);
      this.reportPlace.append(chart.root);
    });
    this.mark(this.marked);
  }

  /** 2: forces and energies are those of a metre of depth. */
  private get dimension(): 2 | 3 {
    const { dimension, forces_per_metre: perMetre = true } = this.values.recording.header;
    return dimension === 2 && perMetre ? 2 : 3;
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
    this.probeCharts.forEach((chart) => chart.mark(time));
    const { number } = this.values.recording.frames[index];
    this.reportCharts.forEach((chart) => chart.mark(time, this.over ? number : null));
  }

  redraw(): void {
    this.lineChart.redraw();
    [...this.probeCharts, ...this.reportCharts].forEach((chart) => chart.redraw());
  }
}
