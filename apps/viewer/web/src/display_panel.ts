/** The part of the panel that live scenes and results share: what is drawn and how. */

import type { Controller, GUI } from "lil-gui";

import { COLOR_MAPS } from "./color_map";
import { element } from "./dom";
import { NumberSlider } from "./number_slider";
import type { DrawingChoice } from "./pace";
import type { Field } from "./protocol";
import { ANGLES } from "./revolve";
import type { Theme, ThemeChoice } from "./theme";
import { vectorFields } from "./vectors";
import type { Look, Viewport } from "./viewport";

export interface DisplayChoices extends Look {
  field: string; // name; "": the body's own colour
  theme: ThemeChoice;
  drawing: DrawingChoice;
}

export interface DisplayEvents {
  field(name: string): void;
  look(): void;
  arrows(name: string): void;
  drawing(choice: DrawingChoice): void;
  complain(words: string): void;
  mostDeformed?: number; // at the end of the slider
  deform?(scale: number): void; // scales the displacement of a recording
  revolve?(): void; // shows the half section of a recording as a revolved body, or itself again
  rangeOver?(choice: "all frames" | "this frame"): void; // sets the range of a recording
}

interface FieldGroup {
  label: string;
  fields: Field[];
}

/** Fields that belong together stand together, in the order in which their groups first appear. */
function groupsOf(fields: Field[]): FieldGroup[] {
  const groups = new Map<string, Field[]>();
  for (const field of fields) {
    const label = field.group ?? field.label;
    groups.set(label, [...(groups.get(label) ?? []), field]);
  }
  return [...groups].map(([label, members]) => ({ label, fields: members }));
}

/** Puts the options of a list, after the first, under the headings of their groups; a group of one needs none. */
function groupOptions(select: HTMLSelectElement, groups: FieldGroup[]): void {
  const options = [...select.options].slice(1);
  for (const { label, fields } of groups) {
    const members = options.splice(0, fields.length);
    if (members.length < 2) select.append(...members);
    else select.append(element("optgroup", { label }, ...members));
  }
}

export class DisplayPanel {
  readonly folder: GUI;

  constructor(
    gui: GUI,
    private readonly choices: DisplayChoices,
    viewport: Viewport,
    theme: Theme,
    events: DisplayEvents,
  ) {
    const folder = gui.addFolder("Display");
    const apply = () => {
      viewport.setLook(this.look());
      events.look();
    };
    const { axisymmetric, fields, parts, colliders = [], marks = [], connectors = [] } = viewport.header;
    const groups = groupsOf(fields);
    const sorted = groups.flatMap((group) => group.fields);
    const options = Object.fromEntries([["body colour", ""], ...sorted.map((field) => [field.label, field.name])]);
    const named = (controller: Controller, id: string, name: string) => {
      controller.domElement.dataset.testid = `show-${id}`;
      return controller.name(name).onChange(apply);
    };
    const colours = named(folder.add(choices, "field", options), "field", "Colour by").onChange(events.field);
    groupOptions(colours.domElement.querySelector("select")!, groups);
    if (events.rangeOver) {
      const range = folder.add({ over: "all frames" }, "over", ["all frames", "this frame"]);
      named(range, "range", "Colour range of").onChange(events.rangeOver);
    }
    named(folder.add(choices, "colorMap", Object.keys(COLOR_MAPS)), "colorMap", "Colour map");
    if (events.deform) {
      const range = {
        least: 0,
        greatest: events.mostDeformed ?? 10,
        step: 0.1,
        unit: "",
        allowed: [0, 1e9] as [number, number],
        complain: events.complain,
      };
      named(new NumberSlider(folder, { scale: 1 }, "scale", range), "deformation", "Displacement ×").onChange(
        events.deform,
      );
    }
    if (events.revolve && axisymmetric) {
      const angles = Object.fromEntries(ANGLES.map((angle) => [angle === 0 ? "half section" : `${angle}°`, angle]));
      named(folder.add(choices, "revolve", angles), "revolve", "Revolved").onChange(events.revolve);
    }
    const vectors = Object.fromEntries(vectorFields(fields).map(({ label, name }) => [label, name]));
    named(folder.add(choices, "arrows", { none: "", ...vectors }), "arrows", "Arrows").onChange((name: string) => {
      apply();
      events.arrows(name);
    });
    named(folder.add(choices, "wireframe"), "wireframe", "Wireframe (w)");
    if (!viewport.flat) named(folder.add(choices, "edges"), "edges", "Edges (e)");
    if (parts.some((_, i) => !viewport.isShown(i))) named(folder.add(choices, "cells"), "cells", "Coarse cells (c)");
    if (!viewport.flat) {
      named(folder.add(choices, "ground"), "ground", "Show ground");
      named(folder.add(choices, "parallel"), "parallel", "Orthographic view (o)");
    }
    if (colliders.length > 0) named(folder.add(choices, "colliders"), "colliders", "Show colliders");
    if (marks.length + connectors.length > 0) {
      const others = connectors.length > 0 ? ", joints, cables" : "";
      named(folder.add(choices, "marks"), "marks", `Boundary conditions, loads${others} (m)`);
    }
    named(folder.add(choices, "drawing", ["auto", "full", "light"]), "drawing", "Graphics").onChange(events.drawing);
    named(folder.add(choices, "theme", ["auto", "light", "dark"]), "theme", "Theme").onChange((choice: ThemeChoice) =>
      theme.choose(choice),
    );
    if (!viewport.flat) {
      const cut = folder.addFolder("Section cut").close();
      named(cut.add(choices, "cut"), "cut", "Show the cut (x)");
      named(cut.add(choices, "cutAxis", ["x", "y", "z"]), "cutAxis", "Normal");
      const share = {
        least: 0,
        greatest: 1,
        step: 0.01,
        unit: "",
        allowed: [0, 1] as [number, number],
        complain: events.complain,
      };
      named(new NumberSlider(cut, choices, "cutAt", share), "cutAt", "Position");
      named(cut.add(choices, "cutFlip"), "cutFlip", "Flip side");
    }
    this.folder = folder;
  }

  look(): Look {
    const { field: _field, theme: _theme, drawing: _drawing, ...look } = this.choices;
    return look;
  }

  /** Shows choices that were changed by a key or by the address. */
  refresh(): void {
    this.folder.controllersRecursive().forEach((controller) => controller.updateDisplay());
  }
}
