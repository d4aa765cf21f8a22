/** The colour bar with its range, which may be typed in, and unit. */

import { cssGradient, type ColorMap } from "./color_map";
import { element, setText } from "./dom";
import { wordsOfComma } from "./number_slider";
import { plain, roundTicks, scaledUnit } from "./numbers";
import type { Field } from "./protocol";

export class ColorBar {
  readonly root: HTMLElement;
  private readonly title = element("div", { class: "bar-title" });
  private readonly unit = element("span", { class: "bar-unit" });
  private readonly name = element("span", {});
  private readonly top: HTMLInputElement;
  private readonly bottom: HTMLInputElement;
  private readonly ticks = element("div", { class: "bar-ticks" });
  private readonly ramp = element("div", { class: "bar-ramp" });
  private readonly arrows = element("div", { class: "bar-arrows", data: "bar-arrows", hidden: true });
  private readonly body: HTMLElement;
  private hasField = false;
  private readonly note = element("div", { class: "bar-note", data: "bar-note", hidden: true });
  private ticksOf = "";
  private readonly automatic: HTMLButtonElement;
  private range: [number, number] = [0, 1];
  private factor = 1; // factor of the unit that the numbers are shown in

  /** `edited`: the user typed a range, or null for the range of the values; `complain`: about what was typed. */
  constructor(
    private readonly edited: (range: [number, number] | null) => void,
    private readonly complain: (words: string) => void,
  ) {
    const input = (place: string) =>
      element("input", {
        class: "bar-end",
        data: `bar-${place}`,
        "aria-label": place === "greatest" ? "upper limit of the colour range" : "lower limit of the colour range",
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
    this.setMap("viridis");
    this.title.append(this.name, " ", this.unit);
    const marks = element("div", { class: "bar-marks" }, this.top, this.ticks, this.bottom);
    this.body = element("div", {}, this.title, element("div", { class: "bar-body" }, this.ramp, marks), this.automatic);
    const card = { class: "card bar", data: "color-bar", hidden: true };
    this.root = element("div", card, this.body, this.note, this.arrows);
  }

  setMap(map: ColorMap): void {
    this.ramp.style.background = cssGradient("to top", map);
  }

  /** One line below: how the picture differs from what is computed; empty: it does not. */
  setNote(words: string): void {
    setText(this.note, words);
    this.note.hidden = words === "";
  }

  /** One line on the arrows; empty: there are none. */
  setArrows(words: string): void {
    setText(this.arrows, words);
    this.showParts();
  }

  private showParts(): void {
    this.body.hidden = !this.hasField;
    this.arrows.hidden = this.arrows.textContent === "";
    this.root.hidden = this.body.hidden && this.arrows.hidden;
  }

  /** The colour bar as a film shows it: null where there are no colours. */
  get shown(): { title: string; ends: [number, number]; ticks: number[] } | null {
    if (!this.hasField) return null;
    const [low, high] = this.range.map((value) => value / this.factor);
    return { title: this.title.textContent ?? "", ends: [low, high], ticks: innerTicks(low, high) };
  }

  private readInputs(): void {
    const number = (input: HTMLInputElement) => this.factor * Number(input.value.replace("\u2212", "-"));
    const [low, high] = [number(this.bottom), number(this.top)];
    if (Number.isFinite(low) && Number.isFinite(high) && low < high) return this.edited([low, high]);
    const typed = [this.bottom, this.top].find((input) => !Number.isFinite(number(input)))?.value;
    if (typed === undefined) this.complain("The value at the top of the colours must be above that at the bottom.");
    else this.complain(wordsOfComma(typed, "") ?? `“${typed}” is not a number.`);
    this.show(this.range);
  }

  /** `typed`: the range is the user's own. */
  set(field: Field | null, range: [number, number], typed: boolean): void {
    this.hasField = field !== null;
    this.showParts();
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
    const ticks = innerTicks(low, high);
    const key = ticks.map((t) => `${t}@${((t - low) / (high - low)).toFixed(3)}`).join();
    if (key === this.ticksOf) return;
    this.ticksOf = key;
    this.ticks.replaceChildren(
      ...ticks.map((tick) => {
        const made = element("span", {}, plain(tick));
        made.style.bottom = `${((100 * (tick - low)) / (high - low)).toFixed(2)}%`;
        return made;
      }),
    );
  }
}

const CLEAR = 0.1; // distance, relative to the bar, between an end and the round number beside it

/** Round numbers that do not meet those at the ends. */
function innerTicks(low: number, high: number): number[] {
  const clear = CLEAR * (high - low);
  return roundTicks(low, high, 5).filter((tick) => tick > low + clear && tick < high - clear);
}
