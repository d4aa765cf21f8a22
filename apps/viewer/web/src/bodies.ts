/** The list of bodies in the panel: shown or hidden, how transparent, and which one the controls of materials are for. */

import type { GUI } from "lil-gui";
import { element, icon } from "./dom";
import { BODY_COLORS, type Viewport } from "./viewport";

export interface BodyLook {
  visible: boolean;
  opacity: number; // 0.05 to 1
}

const LEAST_OPACITY = 0.05;

export class BodyList {
  private readonly rows: { root: HTMLElement; name: HTMLButtonElement; index: number | null }[] = [];
  selected: number | null = 0; // null: all

  /** `chosen`: null where nothing follows from a choice, as in results. */
  constructor(
    folder: GUI,
    viewport: Viewport,
    looks: Map<string, BodyLook>,
    private readonly events: { look(): void; chosen: ((body: number | null) => void) | null },
  ) {
    const names = viewport.bodyNames;
    const list = element("div", { class: "body-list", data: "bodies", role: "group", "aria-label": "bodies" });
    folder.$children.append(list);
    if (events.chosen) list.append(this.row(null, "All bodies", null));
    names.forEach((name, i) => {
      const look = looks.get(name) ?? { visible: true, opacity: 1 };
      looks.set(name, look);
      const apply = () => {
        viewport.setBodies(looks);
        events.look();
      };
      const eye = element("button", { type: "button", class: "icon eye", data: `show-body-${name}` });
      const showEye = () => {
        eye.replaceChildren(icon(look.visible ? "eye" : "eye-closed"));
        eye.title = look.visible ? `Hide ${name}` : `Show ${name}`;
        eye.setAttribute("aria-label", eye.title);
        eye.setAttribute("aria-pressed", String(!look.visible));
      };
      eye.addEventListener("click", () => {
        look.visible = !look.visible;
        showEye();
        apply();
      });
      showEye();
      const opacity = element("input", {
        type: "range",
        class: "number-slider",
        min: String(LEAST_OPACITY),
        max: "1",
        step: "0.05",
        value: String(look.opacity),
        title: "Opacity",
        "aria-label": `opacity of ${name}`,
        data: `opacity-${name}`,
        on: {
          input: () => {
            look.opacity = Number(opacity.value);
            apply();
          },
        },
      });
      list.append(this.row(i, name, [eye, opacity]));
    });
    viewport.setBodies(looks);
    this.choose(events.chosen ? 0 : null);
  }

  private row(index: number | null, name: string, tools: [HTMLElement, HTMLElement] | null): HTMLElement {
    const label = element("button", {
      type: "button",
      class: "body-name",
      title: name,
      data: `body-${index ?? "all"}`,
    });
    const swatch = element("i", { class: "swatch" });
    if (index !== null)
      swatch.style.background = `#${BODY_COLORS[index % BODY_COLORS.length].toString(16).padStart(6, "0")}`;
    label.append(swatch, name);
    label.disabled = this.events.chosen === null;
    label.addEventListener("click", () => this.choose(index));
    const root = element(
      "div",
      { class: "body-row" },
      ...(tools ? [tools[0]] : []),
      label,
      ...(tools ? [tools[1]] : []),
    );
    this.rows.push({ root, name: label, index });
    return root;
  }

  choose(body: number | null): void {
    this.selected = body;
    for (const { name, index } of this.rows)
      name.setAttribute("aria-pressed", String(this.events.chosen !== null && index === body));
    this.events.chosen?.(body);
  }
}
