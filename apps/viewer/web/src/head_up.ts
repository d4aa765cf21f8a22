/** The head-up line of a live scene: how fast, how far from the exact solution, and in words. */

import { element, setText } from "./dom";
import { fixed, perDepth, power, withUnit } from "./numbers";
import type { Status } from "./protocol";
import { grouped } from "./warnings";

const PHASES: [keyof Status, string][] = [
  ["assembly_ms", "assembly"],
  ["solve_ms", "solve"],
  ["surface_ms", "surface"],
  ["other_ms", "other"],
];

export class HeadUp {
  readonly root = element("footer", { class: "head-up", data: "head-up" });
  private readonly values = new Map<string, HTMLElement>();
  private readonly phases: HTMLElement[] = [];
  private readonly contact: HTMLElement;
  private readonly words = element("div", { class: "words", data: "words", role: "status" });
  private readonly stateWords = element("span", { class: "state-words" });
  private readonly warning = element("span", { class: "warning-words", data: "warning" });
  private readonly more = element(
    "button",
    { type: "button", class: "more", data: "words-more", hidden: true },
    "more",
  );
  private isOpen = false;
  private dimension: 2 | 3 = 3;

  constructor() {
    this.add("real_time_ratio", "real time", "simulated over real time", 6);
    const bar = element("span", { class: "phases", "aria-hidden": "true" });
    PHASES.forEach(([, name], i) => {
      const piece = element("i", { class: `phase-${i}`, title: name });
      this.phases.push(piece);
      bar.append(piece);
    });
    this.add("step_ms", "step", "milliseconds of one step", 8).append(bar);
    this.add("phases", "assembly + solve + surface + other", "milliseconds of one step by phase", 22, "wide");
    this.add("iterations", "Newton · CG", "iterations of the last step", 8);
    this.add("residual", "force residual", "the largest unbalanced force, absolute and relative to the load", 17);
    this.add("volume", "smallest volume ratio", "smallest volume ratio J (deformed over reference volume)", 6);
    this.add("inverted", "inverted elements", "number of inverted elements", 5, "wide");
    this.contact = this.add(
      "contact",
      "smallest gap · pairs",
      "contact: the smallest gap, and the number of active contact pairs",
      15,
    );
    this.contact.hidden = true;
    this.words.append(this.stateWords, this.warning, this.more);
    // All of the line is to be hit: it is small for a finger.
    this.words.addEventListener("click", () => !this.more.hidden && this.open(!this.isOpen));
    this.root.prepend(this.words);
    new ResizeObserver(() => this.offerMore()).observe(this.root);
    this.open(false);
  }

  /** All of the state and its warnings, in as many lines as they need; or one line. */
  private open(isOpen: boolean): void {
    this.isOpen = isOpen;
    this.words.classList.toggle("open", isOpen);
    this.more.setAttribute("aria-expanded", String(isOpen));
    setText(this.more, isOpen ? "less" : "more");
    this.offerMore();
  }

  /** The button is there where words are cut off. */
  private offerMore(): void {
    const isCut = [this.stateWords, this.warning].some((words) => words.scrollWidth > words.clientWidth + 1);
    this.more.hidden = !isCut && !this.isOpen;
    this.words.classList.toggle("cut", !this.more.hidden);
  }

  private add(name: string, label: string, title: string, width: number, extra = ""): HTMLElement {
    const value = element("b", { data: name }, "–");
    value.style.minWidth = `${width}ch`;
    const item = element(
      "div",
      { class: `item ${extra}`, title, "data-item": name },
      element("small", {}, label),
      value,
    );
    this.values.set(name, value);
    this.root.append(item);
    return item;
  }

  setDimension(dimension: 2 | 3): void {
    this.dimension = dimension;
  }

  set(status: Status): void {
    const text = (name: string, value: string) => setText(this.values.get(name)!, value);
    text("real_time_ratio", status.at_rest ? "at rest" : `${fixed(status.real_time_ratio, 2)}×`);
    text("step_ms", `${fixed(status.step_ms, 2)} ms`);
    text("phases", PHASES.map(([key]) => fixed(status[key] as number, 2)).join(" + "));
    text("iterations", `${status.newton_iterations} · ${status.linear_iterations}`);
    const share = status.relative_residual;
    text(
      "residual",
      `${power(status.residual)} ${perDepth("N", this.dimension)} (${share < 1e-4 ? power(100 * share) : fixed(100 * share, 2)} %)`,
    );
    text("volume", fixed(status.min_volume_ratio, 3));
    text("inverted", String(status.inverted_cells));
    this.contact.hidden = status.active_pairs === null;
    const gap = status.smallest_gap === null ? "–" : withUnit(status.smallest_gap, "m", 2);
    text("contact", `${gap} · ${status.active_pairs ?? 0}`);
    this.values.get("inverted")!.classList.toggle("bad", status.inverted_cells > 0);
    this.values.get("volume")!.classList.toggle("bad", status.min_volume_ratio <= 0);
    const whole = Math.max(status.step_ms, 1e-9);
    PHASES.forEach(
      ([key], i) => (this.phases[i].style.width = `${Math.min((100 * (status[key] as number)) / whole, 100)}%`),
    );
    const warnings = grouped(status.warnings ?? []);
    const said = status.words || (status.converged ? "converged" : "not converged within one frame");
    const isNew = said !== this.stateWords.textContent || warnings.join("; ") !== this.warning.textContent;
    setText(this.stateWords, said);
    setText(this.warning, warnings.join("; "));
    if (this.stateWords.parentElement === null) this.words.replaceChildren(this.stateWords, this.warning, this.more);
    if (isNew) this.offerMore();
    const isFine = status.converged && warnings.length === 0;
    this.words.dataset.mood = !isFine ? "behind" : status.at_rest ? "rest" : "fine";
  }
}
