/** Small uPlot charts in the colours of the page. */

import uPlot from "uplot";
import { element, setText } from "./dom";
import { plain, withUnit } from "./numbers";
import { styleValue } from "./theme";

export interface Series {
  label: string;
  unit: string;
}

/** Colours that stay apart under colour blindness (style.css), and dashes besides. */
export const STROKES = ["--series-1", "--series-2", "--series-3", "--series-4", "--series-5", "--series-6"];
const DASHES: number[][] = [[], [7, 3], [2, 2.5], [9, 3, 2, 3], [4, 4], [12, 4]];
const DIGIT = 6.6; // width of a digit in the axes' font [pixels]

export interface ChartOptions {
  title: string;
  series: Series[];
  height: number;
  legend: boolean;
  axis: string; // label of the axis: "time [s]"
  points?: boolean; // single values, not a curve
  clicked?: (index: number) => void; // a place on the time axis
}

export class Chart {
  readonly root: HTMLElement;
  private readonly plot: uPlot;
  private readonly legendValues: HTMLElement[] = [];
  private readonly place: HTMLElement;
  private data: uPlot.AlignedData;
  private marker: number | null = null;

  constructor(private readonly options: ChartOptions) {
    this.place = element("div", { class: "chart-plot", role: "img", "aria-label": options.title });
    this.root = element("section", { class: "chart" }, element("h3", {}, options.title), this.place);
    if (options.legend) this.root.append(this.legend());
    this.data = [[], ...options.series.map(() => [])];
    this.plot = new uPlot(this.plotOptions(), this.data, this.place);
    this.plot.over.addEventListener("click", () => {
      const index = this.plot.cursor.idx;
      if (index !== null && index !== undefined) options.clicked?.(index);
    });
    new ResizeObserver(() => this.resize()).observe(this.place);
  }

  private legend(): HTMLElement {
    const list = element("div", { class: "chart-legend" });
    this.options.series.forEach((series, i) => {
      const value = element("b", {});
      const swatch = element("i", { class: i === 0 ? "" : "dashed" });
      swatch.style.borderTopColor = `var(${STROKES[i % STROKES.length]})`;
      this.legendValues.push(value);
      list.append(element("span", {}, swatch, series.label, " ", value));
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
      scales: { x: { time: false } },
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
          values: (_, ticks) => ticks.map((t) => plain(t, 4)),
        },
      ],
      series: [
        {},
        ...this.options.series.map(({ label }, i) => ({
          label,
          stroke: () => styleValue(STROKES[i % STROKES.length]),
          width: 1.75,
          dash: DASHES[i % DASHES.length],
          paths: this.options.points ? () => null : undefined,
          points: { show: this.options.points ?? false, size: 6 },
          spanGaps: false,
        })),
      ],
      hooks: {
        setCursor: [(plot) => this.showValues(plot.cursor.idx ?? this.markedIndex())],
        draw: [(plot) => this.drawMarker(plot)],
      },
    };
  }

  /** Times, then the values of each series; what is not finite leaves a gap. */
  set(times: ArrayLike<number>, values: ArrayLike<number>[]): void {
    const finite = (list: ArrayLike<number>) => Array.from(list, (v) => (Number.isFinite(v) ? v : null));
    this.data = [Array.from(times), ...values.map(finite)] as uPlot.AlignedData;
    this.plot.setData(this.data);
    this.showValues(this.plot.cursor.idx ?? this.markedIndex());
  }

  /** A line at the time that is shown. */
  mark(time: number | null): void {
    this.marker = time;
    this.plot.redraw(false, false);
    this.showValues(this.plot.cursor.idx ?? this.markedIndex());
  }

  redraw(): void {
    this.plot.redraw(false, true);
  }

  destroy(): void {
    this.plot.destroy();
    this.root.remove();
  }

  private markedIndex(): number | null {
    const times = this.data[0];
    if (times.length === 0) return null;
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

  private drawMarker(plot: uPlot): void {
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
