/** Small uPlot charts in the colours of the page. */

import uPlot from "uplot";
import { element, iconButton, setText } from "./dom";
import { savePicture, saveTable } from "./export_chart";
import { plain, scaledUnit, withUnit } from "./numbers";
import { styleValue } from "./theme";

export interface Series {
  label: string;
  unit: string;
}

/** Colours that stay apart under colour blindness (style.css), and dashes besides. */
export const STROKES = ["--series-1", "--series-2", "--series-3", "--series-4", "--series-5", "--series-6"];
const DASHES: number[][] = [[], [7, 3], [2, 2.5], [9, 3, 2, 3], [4, 4], [12, 4]];
const ROUNDING = 1e-9; // round-off, relative to the scale of the values
const FLAT = 1e-6; // smallest variation, relative to the value, that is drawn as a curve
const DIGIT = 6.6; // width of a digit in the axes' font [pixels]

export interface ChartOptions {
  title: string;
  series: Series[];
  height: number;
  legend: boolean;
  axis: string; // label of the horizontal axis: "time [s]"
  quantity: string; // label of the vertical axis: "force"
  scale?: number; // scale of the values in the scene; far smaller ones are round-off
  points?: boolean; // single values, not a curve
  loops?: boolean; // values over a quantity that may fall again, joined in their order
  clicked?: (index: number) => void; // a place on the time axis
}

export class Chart {
  readonly root: HTMLElement;
  private readonly plot: uPlot;
  private readonly legendValues: HTMLElement[] = [];
  private readonly place: HTMLElement;
  private data: uPlot.AlignedData;
  private marker: number | null = null;
  private markedPoint: number | null = null; // number of the marked point in loops, where a value stands for several

  constructor(private readonly options: ChartOptions) {
    this.place = element("div", { class: "chart-plot", role: "img", "aria-label": options.title });
    const buttons = element(
      "span",
      { class: "chart-buttons" },
      iconButton("table", "Save these values as CSV", () => this.saveTable()),
      iconButton("picture", "Save this plot as PNG", () => this.savePicture()),
    );
    const head = element("div", { class: "chart-head" }, element("h3", {}, options.title), buttons);
    this.root = element("section", { class: "chart" }, head, this.place);
    if (options.legend) this.root.append(this.legend());
    this.data = [[], ...options.series.map(() => [])];
    this.plot = new uPlot(this.plotOptions(), this.data, this.place);
    this.plot.over.addEventListener("click", () => {
      const index = this.indexAtCursor();
      if (index !== null) options.clicked?.(index);
    });
    new ResizeObserver(() => this.resize()).observe(this.place);
  }

  private legend(): HTMLElement {
    const list = element("div", { class: "chart-legend" });
    this.options.series.forEach((series, i) => {
      const value = element("b", {});
      this.legendValues.push(value);
      list.append(element("span", {}, swatch(i), series.label, " ", value));
    });
    return list;
  }

  private plotOptions(): uPlot.Options {
    const axis = (size: uPlot.Axis["size"]): uPlot.Axis => ({
      stroke: () => styleValue("--faint"),
      grid: { stroke: () => styleValue("--line"), width: 1 },
      ticks: { show: false },
      font: "11px system-ui, sans-serif",
      size,
      gap: 4,
    });
    return {
      width: 300,
      height: this.options.height,
      padding: [6, 14, 0, 0],
      legend: { show: false },
      cursor: { y: false, drag: { x: false, y: false }, points: { size: 6 } },
      scales: {
        x: { time: false, ...(this.options.loops ? { range: () => rangeOf(...endsOf(this.data[0])) } : {}) },
        y: { range: (_, low, high) => rangeOf(low, high) },
      },
      axes: [
        {
          ...axis(18),
          label: this.options.axis,
          labelSize: 15,
          labelGap: 0,
          labelFont: "11px system-ui, sans-serif",
          space: 50,
          values: (_, ticks) => ticks.map((t) => plain(t)),
        },
        {
          // As wide as its longest number.
          ...axis((_, ticks) => 10 + DIGIT * Math.max(3, ...(ticks ?? []).map((t) => t.length))),
          space: 26,
          label: () => this.quantityWords,
          labelSize: 15,
          labelGap: 0,
          labelFont: "11px system-ui, sans-serif",
          values: (_, ticks) => ticks.map((t) => plain(t / this.unit.factor, 4)),
        },
      ],
      series: [
        {},
        ...this.options.series.map(({ label }, i) => ({
          label,
          stroke: () => styleValue(STROKES[i % STROKES.length]),
          width: 1.75,
          dash: DASHES[i % DASHES.length],
          paths: this.options.points ? () => null : this.options.loops ? joinedInOrder : undefined,
          points: { show: this.options.points ?? false, size: 6 },
          spanGaps: false,
        })),
      ],
      hooks: {
        setCursor: [() => this.showValues(this.indexAtCursor() ?? this.markedIndex())],
        draw: [(plot) => this.drawMarker(plot)],
      },
    };
  }

  /** Times, then the values of each series; what is not finite leaves a gap. */
  set(times: ArrayLike<number>, values: ArrayLike<number>[]): void {
    const size = Math.max(0, ...values.flatMap((list) => Array.from(list, Math.abs).filter(Number.isFinite)));
    // Components that are nothing beside the others, or beside what the scene has, are nothing.
    const least = ROUNDING * Math.max(size, this.options.scale ?? 0);
    const finite = (list: ArrayLike<number>) =>
      Array.from(list, (v) => (!Number.isFinite(v) ? null : Math.abs(v) <= least ? 0 : v));
    this.unit = scaledUnit(size > least ? size : 0, this.options.series[0]?.unit ?? "");
    this.data = [Array.from(times), ...values.map(finite)] as uPlot.AlignedData;
    this.plot.setData(this.data);
    this.showValues(this.indexAtCursor() ?? this.markedIndex());
  }

  private unit = { factor: 1, name: "" };

  private get quantityWords(): string {
    return this.unit.name ? `${this.options.quantity} [${this.unit.name}]` : this.options.quantity;
  }

  private saveTable(): void {
    const { axis, series, title } = this.options;
    const names = series.map(({ label, unit }) => (unit ? `${label} [${unit}]` : label));
    saveTable(title, [axis, ...names], this.data as ArrayLike<number | null>[]);
  }

  private savePicture(): void {
    const entries = this.options.series.map(({ label }, i) => ({
      label,
      color: styleValue(STROKES[i % STROKES.length]),
      dash: DASHES[i % DASHES.length],
    }));
    savePicture(this.options.title, this.plot.ctx.canvas, entries);
  }

  /** A line at the time that is shown; of loops a dot on each curve, at the point of this number. */
  mark(time: number | null, point: number | null = null): void {
    this.marker = time;
    this.markedPoint = point;
    this.plot.redraw(false, false);
    this.showValues(this.indexAtCursor() ?? this.markedIndex());
  }

  get title(): string {
    return this.options.title;
  }

  redraw(): void {
    this.plot.redraw(false, true);
  }

  destroy(): void {
    this.plot.destroy();
    this.root.remove();
  }

  /** The value under the pointer; of loops the nearest point of a curve. */
  private indexAtCursor(): number | null {
    const { cursor } = this.plot;
    if (!this.options.loops) return cursor.idx ?? null;
    const { left = -1, top = -1 } = cursor;
    if (left < 0 || top < 0) return null;
    let [best, least] = [null as number | null, Infinity];
    const [xs, ...rows] = this.data;
    rows.forEach((row) => {
      for (let i = 0; i < xs.length; ++i) {
        if (row[i] === null || row[i] === undefined) continue;
        const away = Math.hypot(this.plot.valToPos(xs[i]!, "x") - left, this.plot.valToPos(row[i]!, "y") - top);
        if (away < least) [best, least] = [i, away];
      }
    });
    return best;
  }

  private markedIndex(): number | null {
    const times = this.data[0];
    if (times.length === 0) return null;
    if (this.options.loops && this.markedPoint !== null && this.markedPoint < times.length) return this.markedPoint;
    if (this.marker === null) return times.length - 1;
    let best = 0;
    for (let i = 1; i < times.length; ++i)
      if (Math.abs(times[i] - this.marker) < Math.abs(times[best] - this.marker)) best = i;
    return best;
  }

  private showValues(index: number | null): void {
    this.legendValues.forEach((place, i) => {
      const value = index === null ? null : this.data[i + 1][index];
      setText(place, value === null || value === undefined ? "–" : withUnit(value, this.options.series[i].unit));
    });
    const said = this.options.series.map(({ label }, i) => `${label} ${this.legendValues[i]?.textContent ?? ""}`);
    this.place.setAttribute("aria-label", `${this.options.title}: ${said.join(", ")}`);
  }

  private drawDots(plot: uPlot): void {
    const index = this.markedIndex();
    const [xs, ...rows] = this.data;
    if (index === null || !Number.isFinite(xs[index])) return;
    const { ctx } = plot;
    ctx.save();
    ctx.fillStyle = styleValue("--accent");
    for (const row of rows) {
      const value = row[index];
      if (value === null || value === undefined) continue;
      ctx.beginPath();
      ctx.arc(
        plot.valToPos(xs[index], "x", true),
        plot.valToPos(value, "y", true),
        4 * devicePixelRatio,
        0,
        2 * Math.PI,
      );
      ctx.fill();
    }
    ctx.restore();
  }

  private drawMarker(plot: uPlot): void {
    if (this.options.loops) return this.drawDots(plot);
    if (this.marker === null) return;
    const x = Math.round(plot.valToPos(this.marker, "x", true));
    const { ctx } = plot;
    ctx.save();
    ctx.strokeStyle = styleValue("--accent");
    ctx.lineWidth = Math.max(1, devicePixelRatio);
    ctx.beginPath();
    ctx.moveTo(x, plot.bbox.top);
    ctx.lineTo(x, plot.bbox.top + plot.bbox.height);
    ctx.stroke();
    ctx.restore();
  }

  private resize(): void {
    const width = this.place.clientWidth;
    if (width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.options.height });
  }
}

/** A piece of the line of a curve, for the legend. */
function swatch(series: number): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 20 4");
  svg.setAttribute("aria-hidden", "true");
  const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
  for (const [name, value] of Object.entries({ x1: "0", x2: "20", y1: "2", y2: "2" })) line.setAttribute(name, value);
  line.style.stroke = `var(${STROKES[series % STROKES.length]})`;
  line.style.strokeDasharray = DASHES[series % DASHES.length].join(" ");
  svg.append(line);
  return svg;
}

/** The least and the greatest of some numbers. */
function endsOf(numbers: ArrayLike<number | null | undefined>): [number | null, number | null] {
  const known = Array.from(numbers).filter((n): n is number => Number.isFinite(n));
  return known.length > 0 ? [Math.min(...known), Math.max(...known)] : [null, null];
}

/** A curve through its points in their order, wherever they are. */
const joinedInOrder: uPlot.Series.PathBuilder = (plot, series) => {
  const path = new Path2D();
  const [xs, ys] = [plot.data[0], plot.data[series]];
  let isOpen = false;
  for (let i = 0; i < xs.length; ++i) {
    const [x, y] = [xs[i], ys[i]];
    if (!Number.isFinite(x) || y === null || y === undefined) {
      isOpen = false;
      continue;
    }
    const [left, top] = [plot.valToPos(x, "x", true), plot.valToPos(y, "y", true)];
    if (isOpen) path.lineTo(left, top);
    else path.moveTo(left, top);
    isOpen = true;
  }
  return { stroke: path, fill: null, clip: null, flags: 0 };
};

/** A range for values that vary by round-off alone: they are drawn as a flat line in the middle. */
function rangeOf(low: number | null, high: number | null): [number, number] {
  if (low === null || high === null || !Number.isFinite(low + high)) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (size === 0) return [-1, 1];
  const span = high - low;
  if (span > FLAT * size) return [low - 0.06 * span, high + 0.06 * span];
  return [Math.min(low - 0.5 * size, 0), Math.max(high + 0.5 * size, 0)];
}
