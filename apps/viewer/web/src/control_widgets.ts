/** One widget of the panel for each kind of control. */

import type { Controller, GUI } from "lil-gui";
import type { Reader } from "./decode";
import { NumberSlider, type NumberRange } from "./number_slider";
import { perDepth, raised } from "./numbers";
import {
  valueReaders,
  type Control,
  type ControlOf,
  type ControlValue,
  type ControlValues,
  type Vector,
} from "./protocol";

/** Surroundings of a widget in the scene. */
export interface WidgetPlace {
  folder: GUI;
  up: Vector;
  dimension: 2 | 3;
  /** One line about what a field holds that is no value. */
  complain(words: string): void;
}

/** The panel's side of a control: follows the program, and says when the user changes it. */
export interface Widget {
  readonly controllers: Controller[];
  /** Follows the program. */
  show(values: ControlValues): void;
  value(): ControlValue;
}

export function makeWidget(control: Control, place: WidgetPlace, values: ControlValues): Widget {
  const widget = build(control, place, values);
  widget.controllers.forEach((controller, i) => {
    controller.domElement.dataset.testid = i === 0 ? `set-${control.key}` : `set-${control.key}-${i}`;
    controller.domElement.title = control.help;
  });
  return widget;
}

function build(control: Control, place: WidgetPlace, values: ControlValues): Widget {
  const { folder } = place;
  const { key, label, kind } = control;
  switch (kind) {
    case "slider":
    case "log_slider": {
      const { least, greatest } = control;
      const unit = perDepth(control.unit, place.dimension);
      const zero = kind === "slider" ? control.zero : undefined;
      const step: NumberRange["step"] = kind === "slider" ? control.step : "logarithmic";
      const range: NumberRange = { least, greatest, step, unit, zero, complain: place.complain };
      return new PlainWidget(key, valueReaders[kind], values, (held) =>
        new NumberSlider(folder, held, "value", range).name(kind === "slider" ? withUnit(label, unit) : label),
      );
    }
    case "switch": {
      const name = control.hotkey ? `${label} (${control.hotkey})` : label;
      return new PlainWidget(key, valueReaders[kind], values, (held) => folder.add(held, "value").name(name));
    }
    case "choice": {
      const options = Object.fromEntries(control.options.map((option) => [option.label, option.name]));
      return new PlainWidget(key, valueReaders[kind], values, (held) => folder.add(held, "value", options).name(label));
    }
    case "arrow":
      return new ArrowWidget(control, place, values);
  }
}

const withUnit = (label: string, unit: string) => (unit ? `${label} [${raised(unit)}]` : label);

/** One controller of lil-gui on the value as it is. */
class PlainWidget<T extends ControlValue> implements Widget {
  readonly controllers: Controller[];
  private readonly held: { value: T };

  constructor(
    private readonly key: string,
    private readonly read: Reader<T>,
    values: ControlValues,
    add: (held: { value: T }) => Controller,
  ) {
    this.held = { value: read(values[key], key) };
    this.controllers = [add(this.held)];
  }

  value(): T {
    return this.held.value;
  }

  show(values: ControlValues): void {
    const value = this.read(values[this.key], this.key);
    if (this.held.value === value) return;
    this.held.value = value;
    this.controllers[0].updateDisplay();
  }
}

const DIRECTIONS = ["down", "up", "left", "right", "back", "front", "as in the scene"] as const;
type Direction = (typeof DIRECTIONS)[number];

/** A vector as its length and its direction in words. */
class ArrowWidget implements Widget {
  readonly controllers: Controller[];
  private readonly held: { length: number; direction: Direction };

  constructor(
    private readonly control: ControlOf<"arrow">,
    private readonly place: WidgetPlace,
    values: ControlValues,
  ) {
    const { folder, dimension } = place;
    const directions = DIRECTIONS.filter((d) => dimension === 3 || (d !== "back" && d !== "front"));
    this.held = this.shown(this.vectorOf(values), "down");
    const { greatest, step, unit } = control;
    const range: NumberRange = { least: 0, greatest, step, unit, complain: place.complain };
    const length = new NumberSlider(folder, this.held, "length", range);
    const direction = folder.add(this.held, "direction", directions);
    this.controllers = [length.name(withUnit(control.label, control.unit)), direction.name("towards")];
  }

  value(): Vector {
    const [x, y, z] = this.unitVector(this.held.direction);
    const scaled = (share: number) => (share === 0 ? 0 : share * this.held.length);
    return [scaled(x), scaled(y), scaled(z)];
  }

  show(values: ControlValues): void {
    const shown = this.shown(this.vectorOf(values), this.held.direction);
    if (shown.length === this.held.length && shown.direction === this.held.direction) return;
    Object.assign(this.held, shown);
    this.controllers.forEach((controller) => controller.updateDisplay());
  }

  private vectorOf(values: ControlValues): Vector {
    return valueReaders.arrow(values[this.control.key], this.control.key);
  }

  /** Nothing has a direction only in what was chosen before. */
  private shown(vector: Vector, before: Direction): { length: number; direction: Direction } {
    const length = Math.hypot(...vector);
    const matches = (direction: Direction) =>
      this.unitVector(direction).every((v, i) => Math.abs(v * length - vector[i]) <= 1e-6 * length);
    const direction = length === 0 ? before : (DIRECTIONS.find(matches) ?? "as in the scene");
    return { length, direction };
  }

  private unitVector(direction: Direction): Vector {
    const [x, y, z] = this.place.up;
    const back: Vector = Math.abs(z) > 0.9 ? [0, 1, 0] : [0, 0, -1];
    switch (direction) {
      case "down":
        return [-x, -y, -z];
      case "up":
        return [x, y, z];
      case "left":
        return [-1, 0, 0];
      case "right":
        return [1, 0, 0];
      case "back":
        return back;
      case "front":
        return [-back[0], -back[1], -back[2]];
      case "as in the scene": {
        const [a, b, c] = this.control.initial;
        const length = Math.hypot(a, b, c);
        return length > 0 ? [a / length, b / length, c / length] : [-x, -y, -z];
      }
    }
  }
}
