/** The axes of the scene as they are seen, whose ends are the standard views; and what belongs to the camera. */

import * as THREE from "three";
import { element, iconButton } from "./dom";
import type { Orbit } from "./orbit";
import type { Viewport } from "./viewport";

const SIZE = 84; // [pixels]
const REACH = 30; // length of an axis [pixels]
const SVG = "http://www.w3.org/2000/svg";

interface Axis {
  way: THREE.Vector3;
  end: HTMLElement;
  line: SVGLineElement | null; // line of the positive half
}

/** Label of the view from the end of an axis. */
const seenFrom = (name: string, isPositive: boolean) => `Look from ${isPositive ? "+" : "−"}${name}`;

export class Triad {
  readonly root = element("div", { class: "card triad", data: "triad", "aria-label": "camera" });
  private readonly axes: Axis[] = [];
  private readonly stage = element("div", { class: "triad-stage" });
  private readonly buttons = element("div", { class: "triad-buttons" });
  private readonly parallel = iconButton("parallel", "Orthographic view (o)", () => this.events.parallel());
  private last = "";

  constructor(private readonly events: { seeAll(): void; parallel(): void; moved(): void }) {
    this.buttons.append(
      iconButton("see-all", "Fit the view (f)", () => events.seeAll()),
      this.parallel,
    );
    this.root.append(this.stage, this.buttons);
  }

  /** Another scene; in 2D there is one view. */
  setScene(viewport: Viewport): void {
    const { flat, orbit } = viewport;
    this.parallel.hidden = flat;
    this.root.classList.toggle("flat", flat);
    this.axes.length = 0;
    this.last = "";
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", `${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`);
    svg.setAttribute("aria-hidden", "true");
    this.stage.replaceChildren(svg);
    for (const [k, name] of (flat ? ["x", "y"] : ["x", "y", "z"]).entries())
      for (const isPositive of flat ? [true] : [true, false]) {
        const way = new THREE.Vector3().setComponent(k, isPositive ? 1 : -1);
        const line = isPositive ? document.createElementNS(SVG, "line") : null;
        if (line) {
          line.setAttribute("class", `axis-${name}`);
          svg.append(line);
        }
        const kind = `triad-end axis-${name}${isPositive ? "" : " back"}`;
        const end = flat
          ? element("span", { class: kind }, name)
          : element("button", {
              type: "button",
              class: kind,
              title: seenFrom(name, isPositive),
              "aria-label": seenFrom(name, isPositive),
              data: `look-${isPositive ? "" : "-"}${name}`,
              on: {
                click: () => {
                  viewport.orbit.lookFrom(way.toArray());
                  viewport.touch();
                  this.events.moved();
                },
              },
            });
        if (isPositive && !flat) end.append(name);
        this.stage.append(end);
        this.axes.push({ way, end, line });
      }
    this.follow(orbit);
  }

  /** To be called for each drawn frame. */
  follow(orbit: Orbit): void {
    const [right, up, out] = [orbit.axis(0), orbit.axis(1), orbit.axis(2)];
    const state = [right, up].flatMap((v) => v.toArray().map((x) => x.toFixed(3))).join() + orbit.isParallel;
    if (state === this.last) return;
    this.last = state;
    this.parallel.setAttribute("aria-pressed", String(orbit.isParallel));
    for (const { way, end, line } of this.axes) {
      const [x, y] = [REACH * way.dot(right), -REACH * way.dot(up)];
      end.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      end.style.zIndex = String(Math.round(10 + 9 * way.dot(out)));
      line?.setAttribute("x2", x.toFixed(1));
      line?.setAttribute("y2", y.toFixed(1));
    }
  }
}
