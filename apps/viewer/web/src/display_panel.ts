/** The part of the panel that live scenes and results share: what is drawn and how. */

import type { GUI } from "lil-gui";
import type { Field } from "./protocol";
import type { Look, Stage } from "./stage";
import type { Theme, ThemeChoice } from "./theme";

export interface DisplayChoices extends Look {
  field: string; // name; "": the body's own colour
  theme: ThemeChoice;
}

export class DisplayPanel {
  readonly folder: GUI;

  constructor(
    gui: GUI,
    readonly choices: DisplayChoices,
    fields: Field[],
    stage: () => Stage,
    theme: Theme,
    fieldChosen: (name: string) => void,
  ) {
    const flat = stage().flat;
    const hasCells = stage().header.parts.some((_, i) => !stage().isShown(i));
    const folder = gui.addFolder("Display");
    const apply = () => stage().setLook(this.look());
    const options = Object.fromEntries([["body colour", ""], ...fields.map((field) => [field.label, field.name])]);
    folder.add(choices, "field", options).name("Colour by").onChange(fieldChosen);
    folder.add(choices, "wireframe").name("Wireframe (w)").onChange(apply);
    if (hasCells) folder.add(choices, "cells").name("Coarse cells (c)").onChange(apply);
    if (!flat) {
      folder.add(choices, "cut").name("Cut (x)").onChange(apply);
      folder.add(choices, "cutAxis", ["x", "y", "z"]).name("Cut across").onChange(apply);
      folder.add(choices, "cutAt", 0, 1, 0.01).name("Cut at").onChange(apply);
      folder.add(choices, "cutFlip").name("Other side").onChange(apply);
      folder.add(choices, "ground").name("Show ground").onChange(apply);
    }
    folder
      .add(choices, "theme", ["auto", "light", "dark"])
      .name("Theme")
      .onChange((choice: ThemeChoice) => theme.choose(choice));
    this.folder = folder;
  }

  look(): Look {
    const { field: _field, theme: _theme, ...look } = this.choices;
    return look;
  }

  /** Shows choices that were changed by a key. */
  refresh(): void {
    this.folder.controllersRecursive().forEach((controller) => controller.updateDisplay());
  }
}
