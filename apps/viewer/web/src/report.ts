/** report.json as far as the page draws it, and the curves that it makes of it. */

import type { Series } from "./charts";
import { perDepth } from "./numbers";
import { flag, list, measurement, object, optional, record, text, type Read } from "./decode";

const reportFrame = object({
  time: measurement,
  load: measurement,
  newton_iterations: optional(measurement),
  min_volume_ratio: optional(measurement),
  energy: optional(record(measurement)),
  probes: optional(record(object({ displacement: optional(list(measurement)) }))),
  reactions: optional(record(list(measurement))),
  mode: optional(
    object({ number: measurement, frequency: measurement, rigid: optional(flag), unstable: optional(flag) }),
  ),
});
type ReportFrame = Read<typeof reportFrame>;

export const readReport = object({
  status: text,
  reason: optional(text),
  warnings: optional(list(text)),
  frames: list(reportFrame),
});
export type Report = Read<typeof readReport>;

export interface Curves {
  title: string;
  quantity: string; // label of the vertical axis
  scale?: number; // scale of the values in the scene
  points?: boolean; // single values
  series: Series[];
  values: number[][]; // one row for each series, one number for each frame of the report
}

export interface TimeAxis {
  label: string;
  unit: string;
  of(frame: { time: number; load: number }, index: number): number;
}

export const axisWords = ({ label, unit }: TimeAxis) => (unit ? `${label} [${unit}]` : label);

/** Time where it passes, else the load factor, else the number of the frame. */
export function timeAxis(frames: { time: number; load: number }[]): TimeAxis {
  const grows = (of: (frame: { time: number; load: number }) => number) =>
    frames.length > 1 && frames.every((frame, i) => i === 0 || of(frame) > of(frames[i - 1]));
  if (frames.some((frame) => "mode" in frame && frame.mode))
    return { label: "mode", unit: "", of: (_, index) => index };
  if (grows((frame) => frame.time)) return { label: "time", unit: "s", of: (frame) => frame.time };
  if (grows((frame) => frame.load)) return { label: "load", unit: "", of: (frame) => frame.load };
  return { label: "frame", unit: "", of: (_, index) => index };
}

const AXES = "xyz";

/** The frequencies over the numbers of the modes; what a run at rest does besides is nothing. */
function curvesOfModes(frames: ReportFrame[]): Curves[] {
  const values = [frames.map(({ mode }) => (mode && !mode.rigid && !mode.unstable ? mode.frequency : NaN))];
  return [
    { title: "Frequency", quantity: "frequency", points: true, series: [{ label: "frequency", unit: "Hz" }], values },
  ];
}

/** `dimension`: forces and energies in 2D are those of a metre of depth. */
export function curvesOf(report: Report, dimension: 2 | 3 = 3): Curves[] {
  const { frames } = report;
  if (frames.some((frame) => frame.mode)) return curvesOfModes(frames);
  const curves: Curves[] = [];
  const keysOf = (pick: (frame: ReportFrame) => object | undefined) => [
    ...new Set(frames.flatMap((frame) => Object.keys(pick(frame) ?? {}))),
  ];
  const [force, energy] = [perDepth("N", dimension), perDepth("J", dimension)];
  const add = (
    title: string,
    quantity: string,
    series: Series[],
    value: (frame: ReportFrame, series: number) => number | undefined,
  ) => {
    const values = series.map((_, s) => frames.map((frame) => value(frame, s) ?? NaN));
    if (values.some((row) => row.some(Number.isFinite))) curves.push({ title, quantity, series, values });
  };
  const components = (unit: string, count: number, letter: string): Series[] =>
    [...AXES.slice(0, count)].map((axis) => ({ label: letter + axis, unit }));
  const count = (pick: (frame: ReportFrame) => number[] | undefined) =>
    Math.max(0, ...frames.map((frame) => pick(frame)?.length ?? 0));

  const energies = keysOf((frame) => frame.energy).filter((name) => frames.some((frame) => frame.energy?.[name]));
  add(
    "Energy",
    "energy",
    energies.map((label) => ({ label, unit: energy })),
    (frame, s) => frame.energy?.[energies[s]],
  );
  for (const name of keysOf((frame) => frame.reactions)) {
    const of = (frame: ReportFrame) => frame.reactions?.[name];
    add(`Reaction of “${name}”`, "force", components(force, count(of), "F"), (frame, s) => of(frame)?.[s]);
  }
  for (const name of keysOf((frame) => frame.probes)) {
    const of = (frame: ReportFrame) => frame.probes?.[name]?.displacement;
    add(`Displacement of “${name}”`, "displacement", components("m", count(of), "u"), (frame, s) => of(frame)?.[s]);
  }
  add("Smallest volume ratio", "J", [{ label: "J", unit: "" }], (frame) => frame.min_volume_ratio);
  add("Newton iterations", "iterations", [{ label: "iterations", unit: "" }], (frame) => frame.newton_iterations);
  // A reaction that is nothing beside the others of the scene is rounding.
  const largest = (quantity: string) =>
    Math.max(
      0,
      ...curves
        .filter((curve) => curve.quantity === quantity)
        .flatMap(({ values }) => values.flat().map(Math.abs).filter(Number.isFinite)),
    );
  return curves.map((curve) => ({ ...curve, scale: largest(curve.quantity) }));
}
