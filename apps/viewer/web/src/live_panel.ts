/** The panel of a live scene: the controls that the program lists, in step with it and with other pages. */

import type { GUI } from "lil-gui";
import { NumberSlider, type NumberRange } from "./number_slider";
import { makeWidget, type Widget } from "./control_widgets";
import type { ControlOf, ControlValue, Hello, PageMessage, State } from "./protocol";

/** Sizes that the tools of the page use. */
export interface ToolSizes {
  pokeRadius: number; // [m]
  faceAngle: number; // [degrees]
  faceRadius: number; // [m]; 0: no limit
}

export interface LiveActions {
  set(key: string, value: ControlValue): void;
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

  constructor(
    private readonly gui: GUI,
    { controls, dimension, extent, saves, state, up }: Hello,
    private readonly actions: LiveActions,
    private readonly tools: ToolSizes,
  ) {
    this.state = state;
    this.switches = controls.filter((control) => control.kind === "switch");
    for (const control of controls) {
      const place = { folder: this.folder(control.folder), up, dimension, complain: actions.complain };
      this.follow(control.key, makeWidget(control, place, state.values));
    }
    this.addTools(extent, saves);
  }

  private folder(name: string): GUI {
    const folder = this.folders.get(name) ?? this.gui.addFolder(name);
    this.folders.set(name, folder);
    return folder;
  }

  private follow(key: string, widget: Widget): void {
    for (const controller of widget.controllers) {
      controller.onChange(() => {
        this.busy = key;
        this.actions.set(key, widget.value());
      });
      controller.onFinishChange(() => (this.busy = null));
    }
    this.widgets.set(key, widget);
  }

  private addTools(extent: number, saves: boolean): void {
    const folder = this.folder(TOOLS);
    const { complain } = this.actions;
    const length = { least: 0, greatest: 0.5 * extent, step: 0.001 * extent, unit: "m", complain };
    const slider = (property: keyof ToolSizes, name: string, help: string, range: NumberRange) => {
      const made = new NumberSlider(folder, this.tools, property, range).name(name);
      made.domElement.dataset.testid = `set-${property.replace(/[A-Z]/g, (letter) => `_${letter.toLowerCase()}`)}`;
      made.domElement.title = help;
    };
    slider("pokeRadius", "Poking ball [m]", "Radius of the ball", {
      ...length,
      least: 0.02 * extent,
      allowed: [1e-6 * extent, 10 * extent],
    });
    slider(
      "faceAngle",
      "Fixed face: angle [°]",
      "Largest angle between the normals of a fixed face and of the clicked point",
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
    const button = (name: string, message: PageMessage) =>
      folder.add({ press: () => this.actions.send(message) }, "press").name(name);
    button("Remove all pins", { type: "unpin_all" });
    button("Free all fixed faces", { type: "free_faces" });
    if (saves) button("Save the scene (Ctrl s)", { type: "save" });
    button("Read the scene again", { type: "reload" });
  }

  /** The keys of switches, and what they do. */
  get hotkeys(): [string, string][] {
    return this.switches.flatMap(({ hotkey, label }) =>
      hotkey ? [[hotkey, `${label.toLowerCase()} on and off`] as [string, string]] : [],
    );
  }

  /** Turns the switch of this key; null: there is none. */
  hotkeyAction(key: string): (() => void) | null {
    const control = this.switches.find(({ hotkey }) => hotkey === key);
    return control ? () => this.actions.set(control.key, !this.state.values[control.key]) : null;
  }

  /** Follows the program. */
  setState(state: State): void {
    this.state = state;
    for (const [key, widget] of this.widgets) if (key !== this.busy) widget.show(state.values);
  }

  /** After a refusal: every control back to what the program has. */
  restore(): void {
    this.busy = null;
    this.setState(this.state);
  }
}
