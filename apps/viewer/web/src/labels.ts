/** Short words that stand at places of the scene. */

import type * as THREE from "three";
import { element, setText } from "./dom";
import type { Orbit } from "./orbit";

interface Label {
  root: HTMLElement;
  place: THREE.Vector3 | null; // null: not shown
}

export class Labels {
  readonly root = element("div", { class: "labels", "aria-hidden": "true" });
  private readonly labels = new Map<string, Label>();

  /** `kind` names its look in the style. */
  set(key: string, words: string, place: THREE.Vector3 | null, kind: string): void {
    let label = this.labels.get(key);
    if (!label) {
      label = { root: element("span", { class: `label ${kind}`, data: `label-${key}` }), place: null };
      this.labels.set(key, label);
      this.root.append(label.root);
    }
    label.place = place?.clone() ?? null;
    setText(label.root, words);
    label.root.hidden = place === null;
  }

  clear(): void {
    this.labels.clear();
    this.root.replaceChildren();
  }

  follow(orbit: Orbit): void {
    for (const { root, place } of this.labels.values()) {
      if (!place) continue;
      const { x, y } = orbit.project(place);
      root.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    }
  }
}
