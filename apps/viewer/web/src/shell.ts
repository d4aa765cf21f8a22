/** What the live page and the results page share: canvas, camera, panel, theme, colours of the shown field. */

import GUI from "lil-gui";
import { ColorBar } from "./color_bar";
import { DisplayPanel, type DisplayChoices, type DisplayEvents } from "./display_panel";
import { element, setText } from "./dom";
import { startInspection, type Inspected } from "./inspect";
import type { Overlays } from "./overlays";
import type { Frame, Header, Topology } from "./protocol";
import { defaultLook, Viewport } from "./viewport";
import type { Normals } from "./surface";
import { Theme } from "./theme";

export interface ShellEvents {
  fieldChosen(name: string): void;
  themeChanged(): void;
  rangeChanged(range: [number, number] | null): void; // null: the user wants that of the values
  /** Before each drawn frame; returns the frame that is drawn when it is new. */
  tick(): Frame | null;
  drawn(frame: Frame): void;
}

export class Shell {
  readonly canvas = element("canvas", { class: "scene", data: "scene", "aria-label": "the scene", tabIndex: 0 });
  readonly title = element("h1", {});
  readonly subtitle = element("p", { class: "subtitle" });
  readonly left = element("div", { class: "left" });
  readonly bottom = element("div", { class: "bottom" });
  readonly panelPlace = element("div", { class: "panel", data: "panel" });
  readonly theme: Theme;
  readonly bar: ColorBar;
  readonly inspected: Inspected;
  readonly choices: DisplayChoices = { ...defaultLook(), field: "", theme: "auto" };
  viewport: Viewport | null = null;
  gui: GUI | null = null;
  display: DisplayPanel | null = null;
  cameraWasKept = false; // by the last new scene, which was the same one
  private typedRange: [number, number] | null = null;
  private easedRange: [number, number] | null = null;
  private easedField = -1;
  private running = true;
  private restPositions: Float32Array = new Float32Array(0);

  constructor(
    kind: string,
    readonly overlays: Overlays,
    private readonly events: ShellEvents,
  ) {
    this.inspected = startInspection(kind);
    this.bar = new ColorBar((range) => this.setRange(range));
    const heading = element("header", { class: "card heading" }, this.title, this.subtitle);
    this.left.append(heading, this.bar.root);
    document.getElementById("app")!.append(this.canvas, this.left, this.panelPlace, this.bottom, overlays.root);
    this.theme = new Theme((dark) => {
      this.viewport?.setDark(dark);
      this.events.themeChanged();
    });
    this.theme.apply();
    // A switch that was clicked gives the keys back to the scene; who goes by Tab keeps the place.
    this.panelPlace.addEventListener("click", ({ target }) => {
      const isSwitch = target instanceof HTMLInputElement && target.type === "checkbox";
      const isButton = target instanceof HTMLElement && target.closest("button") !== null;
      if (isSwitch || isButton) this.canvas.focus({ preventScroll: true });
    });
    new ResizeObserver(() => this.viewport?.resize()).observe(this.canvas);
    Object.assign(this.inspected, {
      stop: () => (this.running = false),
      resume: () => {
        if (!this.running) requestAnimationFrame(this.loop);
        this.running = true;
      },
      drawNow: () => this.draw(true),
      position: (vertex: number) =>
        Array.from(this.viewport?.frame?.positions.subarray(3 * vertex, 3 * vertex + 3) ?? []),
      restPosition: (vertex: number) => Array.from(this.restPositions.subarray(3 * vertex, 3 * vertex + 3)),
      pickAt: (x: number, y: number) => this.viewport?.pickAt(x, y),
      colliderPlaces: () => this.viewport?.colliders.firstPlaces ?? [],
      seenAt: (vertex: number) => this.seenAt(vertex),
    });
    requestAnimationFrame(this.loop);
  }

  /** A new scene, or the same one again after the connection was lost. */
  setScene(header: Header, topology: Topology, normals: (part: number) => Normals): Viewport {
    const old = this.viewport;
    this.restPositions = topology.restPositions;
    const same = old !== null && old.header.title === header.title && old.extent === header.extent;
    const viewport = new Viewport(this.canvas, header, topology, normals, old?.renderer);
    if (same) viewport.orbit.setPose(old.orbit.pose);
    this.cameraWasKept = same;
    old?.dispose();
    this.viewport = viewport;
    viewport.setDark(this.theme.dark);
    viewport.setLook(this.choices);
    document.title = header.title ? `${header.title} · Resilin` : "Resilin";
    setText(this.title, header.title || "Resilin");
    const shown = header.parts.filter((_, i) => viewport.isShown(i));
    const triangles = shown.reduce((sum, part) => sum + part.num_triangles, 0);
    setText(this.subtitle, `${triangles.toLocaleString("en")} triangles`);
    this.gui?.destroy();
    this.gui = new GUI({ container: this.panelPlace, title: "Controls", width: 288 });
    if (matchMedia("(max-width: 720px)").matches) this.gui.close();
    return viewport;
  }

  addDisplay(events: Omit<DisplayEvents, "field">): void {
    const all = { ...events, field: (name: string) => this.events.fieldChosen(name) };
    this.display = new DisplayPanel(this.gui!, this.choices, this.viewport!, this.theme, all);
  }

  private setRange(range: [number, number] | null): void {
    this.typedRange = range;
    this.events.rangeChanged(range);
    this.viewport?.touch();
    this.showRange();
  }

  /** The colours follow the range of the values in a live scene without flicker: up at once, down slowly. */
  followRange(frame: Frame, ease: boolean): void {
    if (frame.field < 0) {
      this.bar.set(null, [0, 1], false);
      return;
    }
    if (frame.field !== this.easedField) this.easedRange = null;
    this.easedField = frame.field;
    const [low, high] = this.easedRange ?? [frame.least, frame.greatest];
    const back = ease ? 0.03 : 1;
    const next: [number, number] = [
      frame.least < low ? frame.least : low + back * (frame.least - low),
      frame.greatest > high ? frame.greatest : high + back * (frame.greatest - high),
    ];
    this.easedRange = next;
    this.showRange(frame.field);
  }

  /** A fixed range, as over all frames of a recording. */
  setFixedRange(range: [number, number]): void {
    this.easedRange = range;
    this.showRange();
  }

  get ownRange(): [number, number] | null {
    return this.typedRange;
  }

  /** `null`: the range of the values. */
  setOwnRange(range: [number, number] | null): void {
    this.setRange(range);
  }

  forgetRange(): void {
    this.easedRange = this.typedRange = null;
  }

  private showRange(field = this.viewport?.frame?.field ?? -1): void {
    if (!this.viewport || field < 0) return;
    const [low, high] = this.typedRange ?? this.easedRange ?? [0, 1];
    const range: [number, number] = [low, high > low ? high : low + Math.max(Math.abs(low) * 1e-6, 1e-30)];
    this.viewport.setBar(...range);
    this.bar.set(this.viewport.header.fields[field], range, this.typedRange !== null);
  }

  private readonly loop = (): void => {
    if (!this.running) return;
    requestAnimationFrame(this.loop);
    this.draw(false);
  };

  private draw(force: boolean): void {
    const frame = this.events.tick();
    if (force) this.viewport?.touch();
    if (this.viewport?.draw()) ++this.inspected.framesDrawn;
    if (frame) this.events.drawn(frame);
  }

  /** Turns a switch of the display on and off, as its key does. */
  toggle(name: "wireframe" | "cells" | "cut"): void {
    this.choices[name] = !this.choices[name];
    this.viewport?.setLook(this.choices);
    this.display?.refresh();
  }

  private seenAt(vertex: number): { x: number; y: number } | null {
    const { viewport } = this;
    if (!viewport?.frame) return null;
    const place = viewport.restBox.min.clone().fromArray(viewport.frame.positions, 3 * vertex);
    return viewport.orbit.project(place);
  }
}
