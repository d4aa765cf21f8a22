/** Numbers as people read them. */

const prefixes = ["p", "n", "µ", "m", "", "k", "M", "G", "T"];
const MINUS = "\u2212";

const withMinus = (text: string) => text.replace("-", MINUS);

/** "12.3 kPa": three digits and a prefix. Ratios have no unit and no prefix. */
export function withUnit(value: number, unit: string, digits = 3): string {
  if (!Number.isFinite(value)) return "–";
  if (!unit) return plain(value, digits);
  if (value === 0) return `0 ${raised(unit)}`;
  const exponent = Math.min(Math.max(Math.floor(Math.log10(Math.abs(value)) / 3 + 1e-9), -4), 4);
  // A prefix would belong to the first factor only: 1 kJ/m^3 reads well, 1 mm^3 does not mean it.
  const scaled = value / 1000 ** exponent;
  return `${plain(scaled, digits)} ${prefixes[exponent + 4]}${raised(unit)}`;
}

/** Factor and name of the unit in which `greatest` has one to three digits before the point: 1000 and "kPa". */
export function scaledUnit(greatest: number, unit: string): { factor: number; name: string } {
  const size = Math.abs(greatest);
  if (!Number.isFinite(size) || size === 0) return { factor: 1, name: raised(unit) };
  const exponent = Math.min(Math.max(Math.floor(Math.log10(size) / 3 + 1e-9), -4), 4);
  const factor = 1000 ** exponent;
  if (unit) return { factor, name: prefixes[exponent + 4] + raised(unit) };
  return size >= 1e4 || size < 1e-3 ? { factor, name: `1e${3 * exponent}` } : { factor: 1, name: "" };
}

/** Up to `digits` significant digits; powers of ten beyond 1e5 and below 1e-4. */
export function plain(value: number, digits = 3): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) return withMinus(value.toExponential(Math.max(digits - 2, 0))).replace("e+", "e");
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return withMinus(String(Number(value.toFixed(decimals))));
}

/** Round numbers between the ends, about `count` of them: 1, 2 or 5 times a power of ten apart. */
export function roundTicks(low: number, high: number, count: number): number[] {
  const span = high - low;
  if (!(span > 0) || !Number.isFinite(span)) return [];
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((m) => m * power >= rough * (1 - 1e-9)) ?? 10);
  const ticks: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * span; ++k)
    ticks.push(Number((k * step).toPrecision(12)));
  return ticks;
}

/** Unit of a force, an energy or a stiffness of a scene in 2D: per metre of depth. */
export function perDepth(unit: string, dimension: 2 | 3): string {
  return dimension === 2 && ["N", "J", "N m"].includes(unit) ? `${unit}/m` : unit;
}

/** A fixed number of decimals, so that a changing number keeps its width. */
export function fixed(value: number, decimals: number): string {
  return Number.isFinite(value) ? withMinus(value.toFixed(decimals)) : "–";
}

/** "1.2e−5", always as wide. */
export function power(value: number): string {
  return Number.isFinite(value) ? withMinus(value.toExponential(1)) : "–";
}

export function raised(unit: string): string {
  return unit.replace("^2", "²").replace("^3", "³");
}

const ROUNDING = 1e-9; // rounding of the scale of a field in its scene

/** A range that is not finer than rounding: what is nearly the same everywhere has one colour, that of the middle. */
export function withoutRounding([low, high]: [number, number], scale: number): [number, number] {
  const least = Math.max(ROUNDING * scale, 1e-6 * Math.max(Math.abs(low), Math.abs(high)), 1e-30);
  if (high - low >= least) return [low, high];
  if (low >= 0 && low < least) return [0, least]; // zero stays at the end of the bar
  const middle = (low + high) / 2;
  return [middle - least / 2, middle + least / 2];
}
