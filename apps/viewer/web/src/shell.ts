/** Parts that the live page and the results page share: canvas, camera, panel, theme, colours of the shown field. */

import GUI from "lil-gui";
import { ColorBar } from "./color_bar";
import { DisplayPanel, type DisplayChoices, type DisplayEvents } from "./display_panel";
import { element, iconButton, setText } from "./dom";
import { download, fileName } from "./download";
import { startInspection, type Inspected } from "./inspect";
import type { Overlays } from "./overlays";
import type { Pose } from "./orbit";
import { FULL_PIXELS, Pace, type DrawingChoice } from "./pace";
import type { Frame, Header, Topology } from "./protocol";
import { mapColor } from "./color_map";
import { Triad } from "./triad";
import { Warnings } from "./warnings";
import { BodyList, type BodyLook } from "./bodies";
import { plain, withUnit } from "./numbers";
import { styleValue } from "./theme";
import type { Place } from "./gestures";
import { Recorder } from "./recorder";
import { withoutRounding } from "./numbers";
import { type Covered, defaultLook, Viewport } from "./viewport";
import type { Normals } from "./surface";
import { Theme } from "./theme";

export interface ShellEvents {
  fieldChosen(name: string): void;
  arrowsChosen(name: string): void; // "": none
  themeChanged(): void;
  cameraMoved(): void;
  rangeChanged(range: [number, number] | null): void; // null: the user wants that of the values
  /** Before each drawn frame; returns the frame that is drawn when it is new. */
  tick(): Frame | null;
  drawn(frame: Frame): void;
}

const TALL = 110; // [pixels] from which on the heading is not just a strip at the top
const MOST_COVERED = 0.3; // largest share of a telephone's height for a card beside the body
const NARROW = 720; // [pixels] of a telephone, as in small.css
const LOW = 520; // [pixels] of a telephone on its side

export class Shell {
  readonly canvas = element("canvas", { class: "scene", data: "scene", "aria-label": "the scene", tabIndex: 0 });
  readonly title = element("h1", {});
  readonly subtitle = element("p", { class: "subtitle" });
  readonly left = element("div", { class: "left" });
  readonly bottom = element("div", { class: "bottom" });
  readonly panelPlace = element("div", { class: "panel", data: "panel" });
  readonly labels = element("div", {});
  readonly warnings = new Warnings();
  readonly triad = new Triad({
    seeAll: () => this.seeAll(),
    parallel: () => this.toggle("parallel"),
    moved: () => this.events.cameraMoved(),
  });
  private readonly pointed = element("span", { class: "label pointed", data: "pointed", hidden: true });
  private bodiesFolder: GUI | null = null; // null: there is one body
  private readonly bodyLooks = new Map<string, BodyLook>();
  readonly theme: Theme;
  readonly bar: ColorBar;
  readonly inspected: Inspected;
  readonly choices: DisplayChoices = { ...defaultLook(), field: "", theme: "auto", drawing: "auto" };
  viewport: Viewport | null = null;
  gui: GUI | null = null;
  display: DisplayPanel | null = null;
  cameraWasKept = false; // by the last new scene, which was the same one
  private typedRange: [number, number] | null = null;
  private easedRange: [number, number] | null = null;
  private easedField = -1;
  private running = true;
  private fitIsWanted = false; // once there is a frame, and the cards have their sizes
  readonly recorder = new Recorder(
    this.canvas,
    () => fileName(document.title.replace(/ · Resilin$/, "")),
    (words, mood) => this.overlays.say(words, mood),
    (pen, scale) => this.paintBar(pen, scale),
  );
  readonly pace = new Pace((isLight, pixels) => {
    this.viewport?.setFinest(pixels);
    this.inspected.isLight = isLight;
  });
  private restPositions: Float32Array = new Float32Array(0);

  constructor(
    kind: string,
    readonly overlays: Overlays,
    private readonly events: ShellEvents,
  ) {
    this.inspected = startInspection(kind);
    this.bar = new ColorBar(
      (range) => this.setRange(range),
      (words) => this.overlays.say(words),
    );
    const heading = element("header", { class: "card heading" }, this.title, this.subtitle, this.warnings.root);
    this.left.append(heading, this.bar.root, this.triad.root);
    document
      .getElementById("app")!
      .append(this.canvas, this.labels, this.pointed, this.left, this.bottom, this.panelPlace, overlays.root);
    this.theme = new Theme((dark) => {
      this.viewport?.setDark(dark);
      this.events.themeChanged();
    });
    this.theme.apply();
    // A switch that was clicked gives the keys back to the scene; who goes by Tab keeps the place.
    document.addEventListener("click", ({ target, detail }) => {
      if (detail === 0 || !(target instanceof HTMLElement || target instanceof SVGElement)) return;
      const isSwitch = target instanceof HTMLInputElement && target.type === "checkbox";
      const isInDialog = target.closest("[role=dialog]") !== null;
      if (isSwitch || (target.closest("button") && !isInDialog)) this.canvas.focus({ preventScroll: true });
    });
    new ResizeObserver(() => this.viewport?.resize(this.covered())).observe(this.canvas);
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
      numCreases: () => this.viewport?.numCreases ?? 0,
      isParallel: () => this.viewport?.orbit.isParallel ?? false,
      pose: () => this.viewport?.orbit.pose,
      arrows: () => this.viewport?.arrows,
      arrowBox: () => this.viewport?.sceneMarks.arrowBox ?? [],
      loadFactors: () => this.viewport?.sceneMarks.factors ?? [],
      connectorPoints: () => this.viewport?.connectors.points ?? [],
      dotPlaces: () => this.viewport?.sceneMarks.dotVertices ?? [],
      colliderPlaces: () => this.viewport?.colliders.firstPlaces ?? [],
      seenAt: (vertex: number) => this.seenAt(vertex),
      project: (x: number, y: number, z: number) => this.project(x, y, z),
      covered: () => this.covered(),
      middleOfBody: () => this.middleOfBody(),
      marksSeen: () => this.viewport?.sceneMarks.seen(this.viewport.orbit, this.viewport.frame!.positions) ?? [],
      loadedFaces: () => this.viewport?.loadedFaces ?? 0,
      heldDots: () => this.viewport?.heldDots ?? 0,
      section: () => this.viewport?.sectionTriangles ?? null,
      fieldRange: () => [this.viewport?.frame?.least, this.viewport?.frame?.greatest],
      isLight: false,
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
    this.labels.replaceChildren(viewport.labels.root);
    viewport.setFinest(this.pace.pixels);
    viewport.setDark(this.theme.dark);
    viewport.setLook(this.choices);
    this.triad.setScene(viewport);
    document.title = header.title ? `${header.title} · Resilin` : "Resilin";
    setText(this.title, header.title || "Resilin");
    const shown = header.parts.filter((_, i) => viewport.isShown(i));
    const triangles = shown.reduce((sum, part) => sum + part.num_triangles, 0);
    setText(this.subtitle, `${triangles.toLocaleString("en")} triangles`);
    this.gui?.destroy();
    this.gui = new GUI({ container: this.panelPlace, title: "Controls", width: 288 });
    if (matchMedia("(max-width: 720px), (max-height: 520px)").matches) this.gui.close();
    this.bodiesFolder = viewport.bodyNames.length > 1 ? this.gui.addFolder("Bodies") : null; // first in the panel
    viewport.resize(this.covered());
    return viewport;
  }

  /** The whole scene in what the cards leave free; at once, or with the first frame. */
  seeAll(): void {
    this.fitIsWanted = this.viewport?.frame == null;
    this.viewport?.resize(this.covered());
    this.viewport?.seeAll();
  }

  /** Looks from a given place, whatever the first frame will be. */
  lookFrom(pose: Pose): void {
    this.fitIsWanted = false;
    this.viewport?.orbit.setPose(pose);
  }

  /** A place in the window where a body is seen, as far in the middle as there is one. */
  middleOfBody(): { x: number; y: number } {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const { left, right, top, bottom } = this.covered();
    const middle = { x: left + (width - left - right) / 2, y: top + (height - top - bottom) / 2 };
    for (let ring = 0; ring < 24; ++ring)
      for (let k = 0; k < Math.max(1, 6 * ring); ++k) {
        const turn = (2 * Math.PI * k) / Math.max(1, 6 * ring);
        const reach = (ring * Math.min(width, height)) / 60;
        const [x, y] = [middle.x + reach * Math.cos(turn), middle.y + reach * Math.sin(turn)];
        if (this.viewport?.pickAt(x, y)) return { x, y };
      }
    return middle;
  }

  /** Margins of the window that cards cover, from each side, so that the bodies are seen as large as can be. */
  covered(): Covered {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const gap = 8;
    const boxOf = (card: Element) => card.getBoundingClientRect();
    const isSeen = (box: DOMRect) => box.width * box.height > 0;
    const below = Math.min(
      height,
      ...[...this.bottom.children]
        .map(boxOf)
        .filter(isSeen)
        .map((box) => box.top),
    );
    const isSmall = width <= NARROW || height <= LOW;
    const seen = this.viewport?.sizeSeen ?? { width: 1, height: 1 };
    const [atLeft, atRight]: Element[][] = [[], []];
    for (const card of this.left.children) (getComputedStyle(card).position === "fixed" ? atRight : atLeft).push(card);
    atRight.push(...this.panelPlace.children);
    const left = atLeft.map(boxOf).filter(isSeen);
    const heading = left[0]; // just a strip at the top of a large window
    if (!isSmall && heading && heading.height <= TALL) left.shift();
    const right = atRight.map(boxOf).filter(isSeen);
    // On a telephone a card that is opened over the scene goes again; a folded panel of a large window takes nothing.
    const isBeside = ({ height: own }: DOMRect) =>
      isSmall ? own < MOST_COVERED * height : Math.max(...right.map((box) => box.bottom)) > MOST_COVERED * height;
    const bottom = height - below + gap;
    const best = freest([
      left.map((box) => [box.right, box.bottom]),
      right.filter(isBeside).map((box) => [width - box.left, box.bottom]),
    ]);
    return { ...best, bottom };

    /** Each card is left free at its side or from above. */
    function freest([leftOnes, rightOnes]: [number, number][][]): Omit<Covered, "bottom"> {
      let [most, found] = [-Infinity, { left: 0, right: 0, top: 0 }];
      const all = [...leftOnes, ...rightOnes];
      for (let choice = 0; choice < 1 << all.length; ++choice) {
        const sides = all.map(([side], i) => (choice & (1 << i) ? side + gap : 0));
        const l = Math.max(0, ...sides.slice(0, leftOnes.length));
        const r = Math.max(0, ...sides.slice(leftOnes.length));
        const top = Math.max(0, ...all.map(([, low], i) => (choice & (1 << i) ? 0 : low + gap)));
        const size = Math.min((width - l - r) / seen.width, (height - top - bottom) / seen.height);
        if (size > most) [most, found] = [size, { left: l, right: r, top }];
      }
      return found;
    }
  }

  /** A list of the bodies where there are several; `chosen`: what the choice of one changes. */
  addBodies(chosen: ((body: number | null) => void) | null, look: () => void): BodyList | null {
    const { viewport } = this;
    if (!viewport || !this.bodiesFolder) return null;
    return new BodyList(this.bodiesFolder, viewport, this.bodyLooks, { look, chosen });
  }

  /** The value of the field under the pointer, beside it; null: the pointer is not over the scene. */
  pointAt(at: Place | null): void {
    const { viewport } = this;
    const hit = at && viewport ? viewport.pickAt(at.x, at.y) : null;
    const value = hit && viewport!.valueAt(hit);
    const field = viewport?.frame ? viewport.header.fields[viewport.frame.field] : undefined;
    this.pointed.hidden = value === null || value === undefined || !field;
    if (this.pointed.hidden) return;
    setText(this.pointed, field!.unit ? withUnit(value!, field!.unit) : plain(value!));
    this.pointed.style.transform = `translate(${at!.x.toFixed(0)}px, ${at!.y.toFixed(0)}px)`;
  }

  /** The bar of colours as films have it. */
  private paintBar(pen: CanvasRenderingContext2D, scale: number): void {
    const shown = this.bar.shown;
    if (!shown) return;
    const { title, ends, ticks } = shown;
    const [x, y, width, height] = [24 * scale, 48 * scale, 14 * scale, 180 * scale];
    for (let i = 0; i < 128; ++i) {
      pen.fillStyle = `rgb(${mapColor(this.choices.colorMap, (i + 0.5) / 128)})`;
      pen.fillRect(x, y + height * (1 - (i + 1) / 128), width, height / 128 + 0.5);
    }
    pen.fillStyle = styleValue("--text");
    pen.textBaseline = "middle";
    pen.font = `600 ${12 * scale}px system-ui, sans-serif`;
    pen.fillText(title, x, y - 18 * scale);
    pen.font = `${12 * scale}px system-ui, sans-serif`;
    const [low, high] = ends;
    for (const tick of [low, ...ticks, high])
      pen.fillText(plain(tick), x + width + 7 * scale, y + height * (1 - (tick - low) / (high - low)));
  }

  addDisplay(events: Omit<DisplayEvents, "field" | "arrows" | "drawing" | "complain">): void {
    const all = {
      ...events,
      field: (name: string) => this.events.fieldChosen(name),
      arrows: (name: string) => this.events.arrowsChosen(name),
    };
    this.display = new DisplayPanel(this.gui!, this.choices, this.viewport!, this.theme, {
      ...all,
      look: () => {
        this.bar.setMap(this.choices.colorMap);
        events.look();
      },
      drawing: (choice: DrawingChoice) => this.pace.choose(choice),
      complain: (words: string) => this.overlays.say(words),
    });
  }

  /** Buttons for films and pictures, for a bar of buttons. */
  get cameraButtons(): HTMLElement[] {
    const picture = iconButton("picture", "Picture without a background (p)", () => this.takePicture());
    return [this.recorder.button, this.recorder.counter, picture];
  }

  /** Saves what is seen as a PNG in all its pixels, without what lies over or behind it. */
  takePicture(): void {
    const { viewport } = this;
    if (!viewport) return;
    viewport.setFinest(FULL_PIXELS);
    this.draw(true);
    const name = `${fileName(viewport.header.title)}.png`;
    this.canvas.toBlob((image) => {
      if (image) download(image, name);
      this.overlays.say(image ? `Saved ${name}.` : "The browser makes no picture of this.", image ? "fine" : "refused");
    });
    viewport.setFinest(this.pace.pixels);
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
    const shown = this.viewport.header.fields[field];
    const range = this.typedRange ?? withoutRounding([low, high], shown.scale ?? 0);
    this.viewport.setBar(...range);
    this.bar.set(shown, range, this.typedRange !== null);
  }

  private readonly loop = (now: number): void => {
    if (!this.running) return;
    requestAnimationFrame(this.loop);
    this.pace.frame(now, this.draw(false));
    this.recorder.frame();
  };

  /** True when something was drawn. */
  private draw(force: boolean): boolean {
    const frame = this.events.tick();
    if (this.fitIsWanted && this.viewport?.frame) this.seeAll();
    if (force) this.viewport?.touch();
    const drawn = this.viewport?.draw() ?? false;
    if (drawn) this.triad.follow(this.viewport!.orbit);
    if (drawn) this.nameArrows();
    if (drawn && this.viewport?.frame) ++this.inspected.framesDrawn;
    if (frame) this.events.drawn(frame);
    return drawn;
  }

  /** Says beside the colours what the longest arrow stands for. */
  private nameArrows(): void {
    const { count, longest } = this.viewport!.arrows;
    const field = this.viewport!.header.fields.find(({ name }) => name === this.choices.arrows);
    this.bar.setArrows(field && count > 0 ? `longest arrow: ${field.label} ${withUnit(longest, field.unit)}` : "");
  }

  /** Turns a switch of the display on and off, as its key does. */
  toggle(name: "wireframe" | "cells" | "cut" | "marks" | "edges" | "parallel"): void {
    this.choices[name] = !this.choices[name];
    this.viewport?.setLook(this.choices);
    this.display?.refresh();
  }

  private project(x: number, y: number, z: number): { x: number; y: number } | null {
    return this.viewport?.orbit.project(this.viewport.restBox.min.clone().set(x, y, z)) ?? null;
  }

  private seenAt(vertex: number): { x: number; y: number } | null {
    const { viewport } = this;
    if (!viewport?.frame) return null;
    const place = viewport.restBox.min.clone().fromArray(viewport.frame.positions, 3 * vertex);
    return viewport.orbit.project(place);
  }
}
