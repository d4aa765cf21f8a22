/** The slider of all panels, with even or logarithmic steps, and a field that takes "20 kPa", "2e4" or more than it shows. */

import { Controller, type GUI } from "lil-gui";
import { element } from "./dom";
import { plain, withUnit } from "./numbers";

const STEPS = 1000; // steps of a logarithmic slider
const PREFIXES: Record<string, number> = { n: 1e-9, µ: 1e-6, u: 1e-6, m: 1e-3, k: 1e3, M: 1e6, G: 1e9 };

/** The number in "20 kPa", "2e4" or "20k"; NaN when there is none. */
export function readNumber(text: string, unit: string): number {
  const found = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*(.*?)\s*$/i.exec(text.replace("\u2212", "-"));
  if (!found) return NaN;
  const written = found[2].replace("²", "^2").replace("³", "^3");
  const factor = written === "" || written === unit ? 1 : factorOf(written, unit);
  return Number(found[1]) * factor;
}

/** The factor of a unit prefix, with or without the unit behind it; NaN for anything else. */
function factorOf(written: string, unit: string): number {
  const rest = written.slice(1).trim();
  return rest === "" || rest === unit ? (PREFIXES[written[0]] ?? NaN) : NaN;
}

/** Words for a number with a decimal comma, "0,3"; null: it is something else. */
export function wordsOfComma(text: string, unit: string): string | null {
  const found = /^([^,]*\d),(\d[^,]*)$/.exec(text.trim());
  if (!found || !Number.isFinite(readNumber(`${found[1]}.${found[2]}`, unit))) return null;
  return `“${text}” is not a number. Write decimals with a point: ${found[1]}.${found[2]}.`;
}

export interface NumberRange {
  least: number; // at the ends of the slider; the field takes more
  greatest: number;
  step: number | "logarithmic";
  unit: string;
  zero?: string; // meaning of 0, in words
  allowed?: [number, number]; // where the page itself refuses; else the program does
  /** One line when the field holds no number. */
  complain(words: string): void;
}

export class NumberSlider<T extends object> extends Controller {
  private readonly slider: HTMLInputElement;
  private readonly field: HTMLInputElement;

  constructor(
    parent: GUI,
    object: T,
    property: keyof T & string,
    private readonly range: NumberRange,
  ) {
    super(parent, object, property, "lil-number");
    const { least, greatest, step } = range;
    this.slider = element("input", {
      type: "range",
      class: "number-slider",
      min: String(this.isLogarithmic ? 0 : least),
      max: String(this.isLogarithmic ? STEPS : greatest),
      step: String(step === "logarithmic" ? 1 : step),
      on: {
        input: () => this.setValue(this.valueAt(Number(this.slider.value))),
        change: () => this.finish(),
      },
    });
    this.field = element("input", {
      class: "number-field",
      spellcheck: false,
      autocomplete: "off",
      inputMode: "text",
      on: {
        change: () => this.readField(),
        blur: () => this.updateDisplay(),
        keydown: (event: KeyboardEvent) => event.key === "Enter" && this.field.blur(),
      },
    });
    this.slider.setAttribute("aria-labelledby", this.$name.id);
    this.field.setAttribute("aria-labelledby", this.$name.id);
    this.$widget.append(this.slider, this.field);
    this.updateDisplay();
  }

  private get isLogarithmic(): boolean {
    return this.range.step === "logarithmic";
  }

  private readField(): void {
    const { unit, zero } = this.range;
    const text = this.field.value.trim();
    const value = zero !== undefined && text === zero ? 0 : readNumber(text, unit);
    const [least, greatest] = this.range.allowed ?? [-Infinity, Infinity];
    if (value >= least && value <= greatest && Number.isFinite(value)) this.setValue(value);
    else if (Number.isFinite(value)) {
      const shown = (number: number) => `${plain(number)}${unit && ` ${unit}`}`;
      const expected = `from ${shown(least)} to ${shown(greatest)}`;
      this.range.complain(`${this.$name.textContent}: expected a number ${expected}, got ${shown(value)}`);
    } else this.range.complain(wordsOfComma(text, unit) ?? this.wordsOfNoNumber(text));
    this.finish();
  }

  private wordsOfNoNumber(text: string): string {
    const { unit } = this.range;
    const example = unit === "" ? "0.25 or 2.5e-1" : `${withUnit(this.getValue() as number, unit)} or 2.5e4`;
    return `“${text}” is not a number${unit && ` in ${unit}`}. Write one such as ${example}.`;
  }

  private finish(): void {
    this._callOnFinishChange();
  }

  private valueAt(place: number): number {
    const { least, greatest } = this.range;
    if (!this.isLogarithmic) return place;
    return Number((least * (greatest / least) ** (place / STEPS)).toPrecision(3));
  }

  private placeOf(value: number): number {
    const { least, greatest } = this.range;
    if (!this.isLogarithmic) return value;
    const share = Math.log(value / least) / Math.log(greatest / least);
    return Math.round(STEPS * Math.min(Math.max(share, 0), 1));
  }

  private get words(): string {
    const value = this.getValue() as number;
    const { unit, zero } = this.range;
    if (value === 0 && zero !== undefined) return zero;
    return this.isLogarithmic ? withUnit(value, unit, 4) : plain(value, 5);
  }

  override updateDisplay(): this {
    this.slider.value = String(this.placeOf(this.getValue() as number));
    this.slider.setAttribute("aria-valuetext", this.words);
    if (document.activeElement !== this.field) this.field.value = this.words;
    return this;
  }
}
