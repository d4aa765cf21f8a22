/** Short ways to make elements. */

type Properties = Record<string, unknown> & { on?: Record<string, (event: never) => void>; data?: string };

/** An element with properties and children; `data` becomes data-testid, `class` the class name. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Properties = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "on") {
      for (const [event, listener] of Object.entries(value as object)) made.addEventListener(event, listener);
    } else if (name === "data") made.dataset.testid = String(value);
    else if (name === "class") made.className = String(value);
    else if (name.includes("-")) made.setAttribute(name, String(value));
    else Object.assign(made, { [name]: value });
  }
  made.append(...children);
  return made;
}

/** Changes text only when it differs, so that an idle page stays idle. */
export function setText(place: HTMLElement, text: string): void {
  if (place.textContent !== text) place.textContent = text;
}

/** Drawings of 24 x 24 for buttons, stroked in the colour of the text. */
const ICONS: Record<string, string> = {
  hand: "M8 13V5.5a1.5 1.5 0 0 1 3 0V11m0-6.5a1.5 1.5 0 0 1 3 0V11m0-4.5a1.5 1.5 0 0 1 3 0V14c0 4-2 7-6 7-3.5 0-4.6-2-6-5l-1.5-3a1.4 1.4 0 0 1 2.4-1.4L8 14",
  pin: "M9 4h6l-1 6 3 3v1H7v-1l3-3zM12 14v7",
  poke: "M12 3a6 6 0 1 1 0 12a6 6 0 1 1 0-12M4 20c2.5-2.5 5-2.5 8 0s5.500 2.500 8 0",
  hold: "M4 13.500h16M8 13.500l-3.500 5M13 13.500l-3.500 5M18 13.500l-3.500 5M12 3.500v7.500M8.500 8l3.500 3.500l3.500-3.500",
  open: "M3.500 18.500v-12h6l2 2.500h9v9.500zM12 16.500v-5M9.500 13.500l2.500-2.500l2.500 2.500",
  record:
    "M12 4.500a7.500 7.500 0 1 0 0 15a7.500 7.500 0 1 0 0-15M12 9.500a2.500 2.500 0 1 0 0 5a2.500 2.500 0 1 0 0-5",
  picture: "M4 7.500h3.500l1.500-2.500h6l1.500 2.500h3.500v11h-16zM12 10a3 3 0 1 0 0 6a3 3 0 1 0 0-6",
  save: "M5 4h11l3 3v13H5zM8 4v5h7V4M8 20v-6h8v6",
  pause: "M8 5v14M16 5v14",
  play: "M7 4.500v15l12-7.500z",
  step: "M6 5v14l9-7zM18 5v14",
  reset: "M4.500 12a7.500 7.500 0 1 0 2.500-5.600M4.500 4v4.500h4.500",
  back: "M9.500 5l-6 7l6 7M4 12h16.500",
  help: "M9 9a3 3 0 1 1 4.500 2.600c-1 .6-1.500 1.200-1.500 2.400M12 17.500v.5",
  sound: "M4 9.5v5h4l5 4.500v-14l-5 4.500zM16.500 9a4 4 0 0 1 0 6M19 6.500a8 8 0 0 1 0 11",
  plots: "M4 4v16h16M7 15l4-5 3 3 5-7",
  "see-all": "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5M9 12a3 3 0 1 0 6 0a3 3 0 1 0-6 0",
  parallel: "M4 8.500l8-4.500l8 4.500v8l-8 4.500l-8-4.500zM4 8.500l8 4.500l8-4.500M12 13v8",
  eye: "M3 12c3-5 6-6.500 9-6.500s6 1.500 9 6.500c-3 5-6 6.500-9 6.500s-6-1.500-9-6.500M12 9.500a2.500 2.500 0 1 0 0 5a2.500 2.500 0 1 0 0-5",
  "eye-closed": "M3 11c3 4 6 5.500 9 5.500s6-1.500 9-5.500M6 14.500l-2 2.500M12 16.500v3M18 14.500l2 2.500",
  undo: "M8 5l-4 4l4 4M4 9h9.500a5.500 5.500 0 0 1 0 11h-5.500",
  settle: "M12 3v9M8.500 8.500l3.500 3.500l3.500-3.500M4 16h16M7 20h10",
  load: "M4 19h16M7 4v11M4.500 12.500l2.500 2.500l2.500-2.500M17 4v11M14.500 12.500l2.500 2.500l2.500-2.500M12 4v11M9.500 12.500l2.500 2.500l2.500-2.500",
  line: "M5 19L19 5M3.500 17.500a2 2 0 1 0 3 3a2 2 0 1 0-3-3M17.500 3.500a2 2 0 1 0 3 3a2 2 0 1 0-3-3",
  table: "M4 5h16v14H4zM4 10h16M4 14.500h16M10 5v14",
  link: "M10 14a4 4 0 0 0 6 0l3-3a4 4 0 0 0-6-6l-1 1M14 10a4 4 0 0 0-6 0l-3 3a4 4 0 0 0 6 6l1-1",
};

export function icon(name: string): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

export function iconButton(name: string, label: string, press: () => void): HTMLButtonElement {
  const button = element("button", { class: "icon", type: "button", title: label, data: `button-${name}` }, icon(name));
  button.setAttribute("aria-label", label);
  button.addEventListener("click", press);
  return button;
}
