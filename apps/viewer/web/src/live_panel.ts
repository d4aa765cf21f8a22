/** The panel of a live scene: every control of the program, in step with it and with other pages. */

import type { Controller, GUI } from "lil-gui";
import { LogSlider } from "./log_slider";
import type { Header, State, Vector } from "./protocol";

export interface LiveActions {
  set(key: keyof State, value: unknown): void;
  send(message: object): void;
}

const DIRECTIONS = ["down", "up", "left", "right", "back", "front", "as in the scene"] as const;
type Direction = (typeof DIRECTIONS)[number];

/** What the panel shows of the state; gravity as strength and direction. */
interface Shown extends Omit<State, "gravity" | "pinned" | "grabbed_by" | "poking" | "warnings"> {
  strength: number; // [m/s^2]
  direction: Direction;
}

export class LivePanel {
  private readonly shown: Shown;
  private readonly controllers = new Map<string, Controller>();
  private busy: string | null = null; // a control under the user's hand does not follow the program
  private state: State;
  private readonly sceneGravity: Vector;

  constructor(
    readonly gui: GUI,
    private readonly header: Header,
    state: State,
    private readonly actions: LiveActions,
    private readonly ball: { pokeRadius: number }, // [m]
  ) {
    this.state = state;
    this.sceneGravity = header.gravity;
    this.shown = this.shownOf(state);
    this.addMaterial();
    this.addWorld();
    this.addTime();
  }

  private addMaterial(): void {
    const folder = this.gui.addFolder("Material");
    const laws = Object.fromEntries((this.header.laws ?? []).map(({ name, label }) => [label, name]));
    this.control("law", folder.add(this.shown, "law", laws).name("Law"));
    this.control("youngs_modulus", this.log(folder, "youngs_modulus", 1e2, 1e8, "Pa").name("Young's modulus"));
    this.control("poissons_ratio", folder.add(this.shown, "poissons_ratio", 0, 0.495, 0.005).name("Poisson's ratio"));
    this.control("damping", folder.add(this.shown, "damping", 0, 10, 0.01).name("Damping [1/s]"));
  }

  private addWorld(): void {
    const folder = this.gui.addFolder("World");
    const directions =
      this.header.dimension === 2 ? DIRECTIONS.filter((d) => d !== "back" && d !== "front") : DIRECTIONS;
    this.control("strength", folder.add(this.shown, "strength", 0, 30, 0.01).name("Gravity [m/s²]"), () =>
      this.setGravity(),
    );
    this.control("direction", folder.add(this.shown, "direction", [...directions]).name("towards"), () =>
      this.setGravity(),
    );
    this.control("ground", folder.add(this.shown, "ground").name("Ground (g)"));
    const step = 10 ** Math.floor(Math.log10(this.header.extent) - 2);
    const reach = step * Math.ceil((2 * this.header.extent) / step);
    this.control(
      "ground_height",
      folder.add(this.shown, "ground_height", -reach, reach, step).decimals(3).name("Ground height [m]"),
    );
    this.control("max_force", this.log(folder, "max_force", 1e-2, 1e5, "N").name("Strongest hand"));
    this.addBall(folder);
  }

  private addBall(folder: GUI): void {
    const { extent } = this.header;
    folder
      .add(this.ball, "pokeRadius", 0.02 * extent, 0.5 * extent)
      .decimals(3)
      .name("Poking ball [m]");
  }

  private addTime(): void {
    const folder = this.gui.addFolder("Time");
    this.control("speed", this.log(folder, "speed", 0.01, 1, "").name("Speed"));
    this.control("time_step", this.log(folder, "time_step", 1e-4, 0.1, "s").name("Time step"));
    this.control("newton_limit", folder.add(this.shown, "newton_limit", 0, 50, 1).name("Newton limit"));
    this.control("tolerance", this.log(folder, "tolerance", 1e-8, 1e-1, "").name("Tolerance"));
    folder.add({ press: () => this.actions.send({ type: "reload" }) }, "press").name("Read the scene again");
    folder.add({ press: () => this.actions.send({ type: "unpin_all" }) }, "press").name("Remove all pins");
  }

  private log(folder: GUI, key: keyof Shown, least: number, greatest: number, unit: string): Controller {
    return new LogSlider(folder, this.shown, key, least, greatest, unit);
  }

  private control(key: string, controller: Controller, changed?: () => void): void {
    controller.domElement.dataset.testid = `set-${key}`;
    controller.onChange((value: unknown) => {
      this.busy = key;
      if (changed) changed();
      else this.actions.set(key as keyof State, value);
    });
    controller.onFinishChange(() => (this.busy = null));
    this.controllers.set(key, controller);
  }

  private setGravity(): void {
    this.actions.set("gravity", this.gravityOf(this.shown.direction, this.shown.strength));
  }

  private gravityOf(direction: Direction, strength: number): Vector {
    const unit = this.unitVector(direction);
    return unit.map((x) => (x === 0 ? 0 : x * strength)) as Vector;
  }

  private unitVector(direction: Direction): Vector {
    const [x, y, z] = this.header.up;
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
        return back.map((v) => -v) as Vector;
      default: {
        const length = Math.hypot(...this.sceneGravity);
        return length > 0 ? (this.sceneGravity.map((v) => v / length) as Vector) : [-x, -y, -z];
      }
    }
  }

  private shownOf(state: State): Shown {
    const strength = Math.hypot(...state.gravity);
    const matches = (direction: Direction) =>
      this.unitVector(direction).every((v, i) => Math.abs(v * strength - state.gravity[i]) <= 1e-6 * strength);
    const kept = strength === 0 && this.shown ? this.shown.direction : undefined;
    return { ...state, strength, direction: kept ?? DIRECTIONS.find(matches) ?? "as in the scene" };
  }

  /** Follows the program. */
  setState(state: State): void {
    this.state = state;
    const shown = this.shownOf(state);
    for (const [key, controller] of this.controllers) {
      if (key === this.busy) continue;
      const values = this.shown as unknown as Record<string, unknown>;
      const value = (shown as unknown as Record<string, unknown>)[key];
      if (value === undefined || values[key] === value) continue;
      values[key] = value;
      controller.updateDisplay();
    }
  }

  /** After a refusal: every control back to what the program has. */
  restore(): void {
    this.busy = null;
    this.setState(this.state);
  }
}
