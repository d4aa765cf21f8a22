/** The colour bar with its range, which may be typed in, and unit. */

import { cssGradient } from "./color_map";
import { element, setText } from "./dom";
import { plain, scaledUnit } from "./numbers";
import type { Field } from "./protocol";

export class ColorBar {
  readonly root: HTMLElement;
  private readonly title = element("div", { class: "bar-title" });
  private readonly unit = element("span", { class: "bar-unit" });
  private readonly name = element("span", {});
  private readonly top: HTMLInputElement;
  private readonly bottom: HTMLInputElement;
  private readonly middles = [0.75, 0.5, 0.25].map(() => element("span", {}));
  private readonly automatic: HTMLButtonElement;
  private range: [number, number] = [0, 1];
  private factor = 1; // factor of the unit that the numbers are shown in

  /** `edited`: the user typed a range, or null for the range of the values. */
  constructor(private readonly edited: (range: [number, number] | null) => void) {
    const input = (place: string) =>
      element("input", {
        class: "bar-end",
        data: `bar-${place}`,
        "aria-label": place === "greatest" ? "value at the top of the colours" : "value at the bottom of the colours",
        inputMode: "decimal",
        spellcheck: false,
        on: { change: () => this.readInputs() },
      });
    this.top = input("greatest");
    this.bottom = input("least");
    this.automatic = element(
      "button",
      {
        type: "button",
        class: "bar-auto",
        title: "range of the values",
        data: "bar-auto",
        on: { click: () => edited(null) },
      },
      "auto",
    );
    const ramp = element("div", { class: "bar-ramp" });
    ramp.style.background = cssGradient("to top");
    this.title.append(this.name, " ", this.unit);
    this.root = element(
      "div",
      { class: "card bar", data: "color-bar", hidden: true },
      this.title,
      element(
        "div",
        { class: "bar-body" },
        ramp,
        element("div", { class: "bar-marks" }, this.top, ...this.middles, this.bottom),
      ),
      this.automatic,
    );
  }

  private readInputs(): void {
    const number = (input: HTMLInputElement) => this.factor * Number(input.value.replace("\u2212", "-"));
    const [low, high] = [number(this.bottom), number(this.top)];
    if (Number.isFinite(low) && Number.isFinite(high) && low < high) this.edited([low, high]);
    else this.show(this.range);
  }

  /** `typed`: the range is the user's own. */
  set(field: Field | null, range: [number, number], typed: boolean): void {
    this.root.hidden = field === null;
    if (!field) return;
    setText(this.name, field.label);
    const { factor, name } = scaledUnit(Math.max(Math.abs(range[0]), Math.abs(range[1])), field.unit);
    this.factor = factor;
    setText(this.unit, name ? `[${name}]` : "");
    this.automatic.hidden = !typed;
    this.show(range);
  }

  private show(range: [number, number]): void {
    this.range = range;
    const [low, high] = range.map((value) => value / this.factor);
    const edit = (input: HTMLInputElement, value: number) => {
      const text = plain(value);
      if (document.activeElement !== input && input.value !== text) input.value = text;
    };
    edit(this.top, high);
    edit(this.bottom, low);
    [0.75, 0.5, 0.25].forEach((t, i) => setText(this.middles[i], plain(low + t * (high - low))));
  }
}
