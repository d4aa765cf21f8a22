/** A slider on a logarithmic scale for lil-gui, with a field that reads "20 kPa" or "2e4". */

import { Controller, type GUI } from "lil-gui";
import { element } from "./dom";
import { withUnit } from "./numbers";

const STEPS = 1000;
const PREFIXES: Record<string, number> = { m: 1e-3, k: 1e3, M: 1e6, G: 1e9 };

/** The number in "20 kPa", "2e4" or "20k"; NaN when there is none. */
export function readNumber(text: string, unit: string): number {
  const found = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*([mkMG]?)\s*(.*?)\s*$/.exec(text.replace("\u2212", "-"));
  if (!found || (found[3] !== "" && found[3] !== unit)) return NaN;
  return Number(found[1]) * (PREFIXES[found[2]] ?? 1);
}

export class LogSlider<T extends object> extends Controller {
  private readonly slider: HTMLInputElement;
  private readonly field: HTMLInputElement;

  constructor(
    parent: GUI,
    object: T,
    property: keyof T & string,
    private readonly least: number,
    private readonly greatest: number,
    private readonly unit: string,
  ) {
    super(parent, object, property, "lil-number");
    this.slider = element("input", {
      type: "range",
      class: "log-slider",
      min: "0",
      max: String(STEPS),
      on: {
        input: () => this.setValue(this.valueAt(Number(this.slider.value))),
        change: () => this.finish(),
      },
    });
    this.field = element("input", {
      class: "log-field",
      spellcheck: false,
      inputMode: "text",
      on: {
        change: () => {
          const value = readNumber(this.field.value, unit);
          if (Number.isFinite(value)) this.setValue(value);
          this.finish();
        },
        blur: () => this.updateDisplay(),
        keydown: (event: KeyboardEvent) => event.key === "Enter" && this.field.blur(),
      },
    });
    this.slider.setAttribute("aria-labelledby", this.$name.id);
    this.field.setAttribute("aria-labelledby", this.$name.id);
    this.$widget.append(this.slider, this.field);
    this.updateDisplay();
  }

  private finish(): void {
    this._callOnFinishChange();
  }

  private valueAt(step: number): number {
    const value = this.least * (this.greatest / this.least) ** (step / STEPS);
    return Number(value.toPrecision(3));
  }

  override updateDisplay(): this {
    const value = this.getValue() as number;
    const share = Math.log(value / this.least) / Math.log(this.greatest / this.least);
    this.slider.value = String(Math.round(STEPS * Math.min(Math.max(share, 0), 1)));
    if (document.activeElement !== this.field) this.field.value = withUnit(value, this.unit);
    return this;
  }
}
