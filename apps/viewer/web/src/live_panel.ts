/** The panel of a live scene: the controls that the program lists, in step with it and with other pages. */

import type { GUI } from "lil-gui";
import { NumberSlider, type NumberRange } from "./number_slider";
import { perDepth } from "./numbers";
import { makeWidget, type Widget } from "./control_widgets";
import type { ControlOf, ControlValue, ControlValues, Hello, PageMessage, State } from "./protocol";

/** Sizes that the tools of the page use. */
export interface ToolSizes {
  pokeRadius: number; // [m]
  faceAngle: number; // [degrees]
  faceRadius: number; // [m]; 0: no limit
  loadKind: "force" | "pressure";
  loadForce: number; // [N], in 2D [N/m]
  loadPressure: number; // [Pa]
}

export interface LiveActions {
  /** `body`: whose material it is; undefined: of all, or of none. `before`: what it was. */
  set(key: string, value: ControlValue, body: number | undefined, before: ControlValue): void;
  send(message: PageMessage): void;
  complain(words: string): void;
}

const TOOLS = "Tools"; // the folder to which the page adds controls of its own

export class LivePanel {
  private readonly widgets = new Map<string, Widget>();
  private readonly folders = new Map<string, GUI>();
  private readonly switches: ControlOf<"switch">[];
  private busy: string | null = null; // a control under the user's hand does not follow the program
  private state: State;
  private readonly ofBody: Set<string>; // keys of controls that each body has of its own
  private body: number | null = null; // the one that they are for; null: all
  private before: ControlValue = 0; // value of the control under the user's hand, before

  constructor(
    private readonly gui: GUI,
    { controls, dimension, extent, saves, state, up }: Hello,
    private readonly actions: LiveActions,
    private readonly tools: ToolSizes,
  ) {
    this.state = state;
    this.ofBody = new Set(controls.filter((control) => control.of_body).map(({ key }) => key));
    this.switches = controls.filter((control) => control.kind === "switch");
    for (const control of controls) {
      const place = { folder: this.folder(control.folder), up, dimension, complain: actions.complain };
      this.follow(control.key, makeWidget(control, place, state.values));
    }
    this.addTools(extent, saves, dimension);
  }

  private folder(name: string): GUI {
    const folder = this.folders.get(name) ?? this.gui.addFolder(name);
    this.folders.set(name, folder);
    return folder;
  }

  private follow(key: string, widget: Widget): void {
    for (const controller of widget.controllers) {
      controller.onChange(() => {
        if (this.busy !== key) this.before = this.valuesShown()[key];
        this.busy = key;
        const body = this.ofBody.has(key) ? (this.body ?? undefined) : undefined;
        this.actions.set(key, widget.value(), body, this.before);
      });
      controller.onFinishChange(() => (this.busy = null));
    }
    this.widgets.set(key, widget);
  }

  private addTools(extent: number, saves: boolean, dimension: 2 | 3): void {
    const folder = this.folder(TOOLS);
    const { complain } = this.actions;
    const length = { least: 0, greatest: 0.5 * extent, step: 0.001 * extent, unit: "m", complain };
    const slider = (
      property: "pokeRadius" | "faceAngle" | "faceRadius",
      name: string,
      help: string,
      range: NumberRange,
    ) => {
      const made = new NumberSlider(folder, this.tools, property, range).name(name);
      made.domElement.dataset.testid = `set-${property.replace(/[A-Z]/g, (letter) => `_${letter.toLowerCase()}`)}`;
      made.domElement.title = help;
    };
    slider("pokeRadius", "Ball radius [m]", "Radius of the rigid ball of the poke tool", {
      ...length,
      least: 0.02 * extent,
      allowed: [1e-6 * extent, 10 * extent],
    });
    slider(
      "faceAngle",
      "Fixed face: angle [°]",
      "Largest angle between the normal at the clicked point and those of the fixed facets",
      {
        least: 1,
        greatest: 90,
        step: 1,
        unit: "°",
        allowed: [0, 180],
        complain,
      },
    );
    slider("faceRadius", "Fixed face: radius [m]", "Largest distance of a fixed face from the clicked point", {
      ...length,
      zero: "no limit",
      allowed: [0, 10 * extent],
    });
    const kind = folder.add(this.tools, "loadKind", { force: "force", pressure: "pressure" }).name("Load on a face");
    kind.domElement.dataset.testid = "set-load_kind";
    kind.domElement.title = "A click with the load tool applies this to the face; a second click removes it";
    const least = 1e-3;
    const amount = (property: "loadForce" | "loadPressure", name: string, unit: string, help: string) => {
      const range: NumberRange = { least, greatest: 1e8, step: "logarithmic", unit, allowed: [-1e15, 1e15], complain };
      const made = new NumberSlider(folder, this.tools, property, range).name(name);
      made.domElement.dataset.testid = `set-${property === "loadForce" ? "load_force" : "load_pressure"}`;
      made.domElement.title = help;
    };
    const force = perDepth("N", dimension);
    amount("loadForce", "Force", force, "Total force on the face, against its normal; a negative one pulls");
    amount("loadPressure", "Pressure", "Pa", "Follower pressure on the face; a negative one is suction");
    const button = (name: string, message: PageMessage) =>
      folder.add({ press: () => this.actions.send(message) }, "press").name(name);
    button("Remove all pins", { type: "unpin_all" });
    button("Release all fixed faces", { type: "free_faces" });
    button("Remove all face loads", { type: "remove_loads" });
    if (saves) button("Save the scene (Ctrl s)", { type: "save" });
    button("Reload the scene", { type: "reload" });
  }

  /** The body with the material that the controls show and change; null: all bodies. */
  chooseBody(body: number | null): void {
    this.body = body;
    this.busy = null;
    this.setState(this.state);
  }

  private valuesShown(): ControlValues {
    const own = this.body === null ? undefined : this.state.bodies?.[this.body];
    return own ? { ...this.state.values, ...own } : this.state.values;
  }

  /** The keys of switches, and what they do. */
  get hotkeys(): [string, string][] {
    return this.switches.flatMap(({ hotkey, label }) =>
      hotkey ? [[hotkey, `${label.toLowerCase()} on and off`] as [string, string]] : [],
    );
  }

  /** Turns the switch of this key; null: there is none. */
  hotkeyAction(hit: string): (() => void) | null {
    const control = this.switches.find(({ hotkey }) => hotkey === hit);
    if (!control) return null;
    const { key } = control;
    return () => this.actions.set(key, !this.state.values[key], undefined, this.state.values[key]);
  }

  /** Follows the program. */
  setState(state: State): void {
    this.state = state;
    const values = this.valuesShown();
    for (const [key, widget] of this.widgets) if (key !== this.busy) widget.show(values);
  }

  /** Motors and cables that the scene moves by itself. */
  followDrives(drives: Record<string, number>): void {
    Object.assign(this.state.values, drives);
    const values = this.valuesShown();
    for (const key of Object.keys(drives)) if (key !== this.busy) this.widgets.get(key)?.show(values);
  }

  /** After a refusal: every control back to what the program has. */
  restore(): void {
    this.busy = null;
    this.setState(this.state);
  }
}
