/** The page of recorded results. */

import { AddressBar, nameOfField, readAddress, type SharedView, writeAddress } from "./address";
import { Crosshair } from "./crosshair";
import { element, iconButton } from "./dom";
import { Gestures, type Place } from "./gestures";
import { arrowOf, belongsToControl, CAMERA_KEYS, keyOf, movesCamera } from "./keys";
import { modesOf } from "./modes";
import { plain } from "./numbers";
import { Overlays } from "./overlays";
import { valuesAlong } from "./line_probe";
import { placeOf, type Hit } from "./picking";
import { Plots } from "./plots";
import type { Frame } from "./protocol";
import type { RecordedValues } from "./recorded_values";
import type { Recording } from "./recording";
import type { Report } from "./report";
import { Revolved } from "./revolve";
import { Shell } from "./shell";
import { goTo, type TakingUp } from "./taking_up";
import { Timeline } from "./timeline";
import { vectorFields } from "./vectors";
import { joined, type Viewport } from "./viewport";
import * as THREE from "three";

const KEYS: [string, string][] = [
  ["left button", "rotate the camera; a click on the body plots the values at that point"],
  ["middle button, Shift and left button", "pan the camera"],
  ["wheel, two fingers", "zoom"],
  ...CAMERA_KEYS,
  ["Space", "play and pause"],
  ["← →", "previous frame, next frame"],
  ["Enter", "probe the body: arrows move the cross, Escape ends it"],
  ["Home End", "first frame, last frame"],
  ["f", "fit the view to the scene"],
  ["w e c x m o", "wireframe, edges, coarse cells, section cut, boundary conditions and loads, orthographic view"],
  ["l", "plot the field along a line between two clicks"],
  ["v p", "record a film; save a picture with a transparent background"],
  ["Escape", "remove the probe"],
  ["?", "this help"],
];

const FRAMES_LOOKED_AT = 60; // for the camera

export class ResultsApp {
  private readonly shell: Shell;
  private readonly overlays = new Overlays(KEYS);
  private readonly timeline: Timeline;
  private readonly plots: Plots;
  private field = -1;
  private chosen = ""; // name of the field that is shown, or will be once it is there
  private wanted: number | null = 0; // frame to be drawn next
  private swing = 1; // swing of a mode
  private scale = 1; // how many times the displacement is drawn
  private hovered: Place | null = null;
  private hasMoved = false; // the pointer, since its value was shown
  private lineCells: Uint32Array | null = null; // cells of all parts, once there was a line
  private line: Hit[] | null = null; // ends of the line along which the field is plotted; null: none is asked for
  private lineButton = iconButton("line", "Plot the field along a line (l)", () => this.toggleLine());
  private readonly crosshair = new Crosshair();
  private probed: number | null = null;
  private rangeOverAll = true;
  private body: Revolved | null = null; // the half section as a revolved body, where that is shown
  private readonly addressBar = new AddressBar(() => (this.timeline.isPlaying ? null : this.view()));

  constructor(
    private readonly values: RecordedValues,
    private readonly report: Report | null,
    private readonly takingUp: TakingUp | null,
  ) {
    const { recording } = values;
    this.shell = new Shell("recorded", this.overlays, {
      fieldChosen: (name) => this.chooseField(name),
      arrowsChosen: (name) => void this.chooseArrows(name),
      themeChanged: () => this.plots?.redraw(),
      cameraMoved: () => this.addressBar.changed(),
      rangeChanged: () => this.showRange(),
      tick: () => this.tick(),
      drawn: () => {},
    });
    const modes = modesOf(recording.frames, report);
    this.overlays.root.append(this.crosshair.root);
    this.setScene();
    this.timeline = new Timeline(recording.frames, modes, {
      shown: (index, swing) => {
        this.wanted = index;
        this.swing = swing;
        this.addressBar.changed();
      },
      share: () => void this.share(),
      takenUp: takingUp ? () => this.takeUp() : null,
    });
    if (takingUp)
      this.overlays.setKeys([...KEYS.slice(0, -1), ["t", "continue the simulation interactively"], ...KEYS.slice(-1)]);
    this.plots = new Plots(values, report, (index) => this.timeline.seek(index));
    this.shell.bottom.append(this.timeline.root);
    this.shell.panelPlace.append(this.plots.root);
    this.shell.left.append(
      element(
        "nav",
        { class: "card toolbar small" },
        iconButton("plots", "Plots", () => (this.plots.root.hidden = !this.plots.root.hidden)),
        this.lineButton,
        ...this.shell.cameraButtons,
        iconButton("help", "Mouse and keys (?)", () => this.overlays.showHelp(true)),
      ),
    );
    if (matchMedia("(max-width: 720px), (max-height: 520px)").matches) this.plots.root.hidden = true;
    this.listen();
    this.applyAddress();
    const { inspected } = this.shell;
    Object.assign(inspected, {
      report,
      seek: (index: number) => this.timeline.seek(index),
      probe: (vertex: number) => this.probe(vertex),
      tone: () => this.timeline.tonePlayed,
    });
  }

  /** The recorded scene, or the body that its half section makes. */
  private setScene(): void {
    const { values, shell, report } = this;
    const { recording } = values;
    const section = { ...recording.header, fields: values.fields };
    const angle = section.axisymmetric ? shell.choices.revolve : 0;
    const colliders = recording.frames[0]?.colliders ?? new Float32Array();
    this.body = angle > 0 ? new Revolved(section, recording.topology, angle, colliders) : null;
    const { header, topology } = this.body ?? { header: section, topology: recording.topology };
    const viewport = shell.setScene(header, topology, (part) =>
      header.parts[part].kind === "skin" ? "smooth" : "creased",
    );
    viewport.setGround(header.ground ?? null);
    viewport.reach = this.reach(viewport, modesOf(recording.frames, report).length > 0);
    if (this.body) viewport.orbit.lookFrom(angle > 180 ? [1, 0.7, 1] : [0.4, 0.6, 1]); // into the opening
    shell.seeAll();
    shell.addBodies(null, () => {});
    shell.addDisplay({
      deform: (scale) => {
        this.scale = scale;
        shell.bar.setNote(scale === 1 ? "" : `displacement scaled by ${plain(scale)}`);
        this.wanted ??= this.timeline.index;
      },
      mostDeformed: this.mostDeformed,
      look: () => this.addressBar.changed(),
      revolve: () => setTimeout(() => this.revolve()), // once the panel, which is made anew, has told of it
      rangeOver: (choice) => {
        this.rangeOverAll = choice === "all frames";
        this.showRange();
      },
    });
    this.describe(recording, report);
    shell.inspected.header = header;
  }

  /** The scene anew, at the angle that was chosen, without what was made of the one before. */
  private resetScene(): void {
    this.line = null;
    this.lineButton.setAttribute("aria-pressed", "false");
    this.hovered = null;
    this.scale = 1; // as the new panel shows it
    this.rangeOverAll = true;
    this.shell.bar.setNote("");
    this.setScene();
  }

  /** Shows the angle that was chosen. */
  private revolve(): void {
    this.resetScene();
    this.wanted = this.timeline.index;
    this.addressBar.changed();
  }

  /** A frame as it is drawn. */
  private drawn(index: number, field: number, swing = 1, scale = 1): Frame {
    const frame = this.values.frame(index, field, swing, scale);
    return this.body ? this.body.frame(frame) : frame;
  }

  /** Where the bodies are in all frames, looked at in some of them; modes swing to both sides. */
  private reach(viewport: Viewport, isOfModes: boolean): THREE.Box3 {
    const { length } = this.values.recording.frames;
    const box = new THREE.Box3();
    const stride = Math.max(1, Math.floor(length / FRAMES_LOOKED_AT));
    for (let i = 0; i < length; ++i)
      if (i % stride === 0 || i === length - 1)
        for (const swing of isOfModes ? [1, -1] : [1]) box.union(viewport.boxOf(this.drawn(i, -1, swing).positions));
    return box.isEmpty() ? viewport.restBox.clone() : box;
  }

  private describe(recording: Recording, report: Report | null): void {
    const words: string[] = [];
    const { frames, skipped, damage } = recording;
    const modes = modesOf(frames, report).filter((mode) => mode !== null).length;
    words.push(modes > 0 ? `${modes} modes` : frames.length === 1 ? "one frame" : `${frames.length} frames`);
    if (skipped > 0) words.push(`one recorded frame in ${skipped + 1}, because memory is short`);
    if (report && report.status !== "done") words.push(report.reason || report.status);
    if (damage) words.push(damage);
    this.shell.warnings.set(report?.warnings ?? []);
    this.shell.subtitle.append(` · ${words.join(" · ")}`);
    if (damage || (report && report.status !== "done")) this.shell.subtitle.classList.add("warn");
  }

  private listen(): void {
    const { takingUp } = this;
    new Gestures(this.shell.canvas, () => this.shell.viewport!.orbit, {
      press: () => false,
      drag: () => {},
      release: () => {},
      click: (at) => this.click(at),
      hover: (at) => {
        this.hovered = at;
        this.hasMoved = true;
      },
      cameraMoved: () => {
        this.shell.viewport!.touch();
        this.addressBar.changed();
      },
    });
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("hashchange", () =>
      takingUp && readAddress(location.hash).from !== undefined ? location.reload() : this.applyAddress(),
    );
  }

  private click(at: Place): void {
    const hit = this.shell.viewport!.pickAt(at.x, at.y);
    if (!hit) return;
    if (this.line === null) return this.probe(this.body ? this.body.source[hit.vertex] : hit.vertex);
    if (this.line.length === 2) this.line = [];
    this.line.push(hit);
    this.plots.root.hidden = false;
    this.wanted ??= this.timeline.index;
    if (this.line.length === 1) this.overlays.say("Click the end of the line.", "fine");
  }

  /** The next two clicks are the ends of a line. */
  private toggleLine(): void {
    if (this.body) return this.overlays.say("A line needs the half section: choose it under Revolved.");
    this.line = this.line === null ? [] : null;
    this.lineButton.setAttribute("aria-pressed", String(this.line !== null));
    if (this.line !== null) this.overlays.say("Click the start of the line.", "fine");
    this.wanted ??= this.timeline.index;
  }

  /** The ends of the line as the frame has them, and the field between them. */
  private showLine(frame: Frame): THREE.Vector3[] {
    const ends = (this.line ?? []).map((hit) => placeOf(hit, frame.positions, new THREE.Vector3()));
    if (ends.length < 2 || this.field < 0) this.plots.showLine(null, this.field);
    else {
      const { topology, header } = this.values.recording;
      const flat = header.dimension === 2;
      this.lineCells ??= joined(flat ? topology.triangles : topology.tetrahedra);
      const line = valuesAlong(this.lineCells, flat ? 3 : 4, frame, ends[0].toArray(), ends[1].toArray());
      this.plots.showLine(line, this.field);
      this.shell.inspected.line = line;
    }
    return ends;
  }

  /** At the end of the slider the largest displacement is about a fifth of the extent. */
  private get mostDeformed(): number {
    const { largestDisplacement, recording } = this.values;
    const wanted = largestDisplacement > 0 ? (0.2 * recording.header.extent) / largestDisplacement : 10;
    const power = 10 ** Math.floor(Math.log10(wanted));
    return Math.min(Math.max(10, power * Math.ceil(wanted / power)), 1e9);
  }

  private probe(vertex: number | null): void {
    this.probed = vertex;
    this.plots.probe(vertex, this.field);
    if (vertex !== null) this.plots.root.hidden = false;
    this.wanted ??= this.timeline.index;
    this.shell.inspected.probed = vertex;
  }

  /** Chooses a field; one that has to be computed is shown when it is there, unless another was chosen meanwhile. */
  private chooseField(name: string, range: [number, number] | null = null): void {
    const { values, shell } = this;
    const field = values.fields.findIndex((entry) => entry.name === name);
    this.chosen = name;
    if (field < 0 || values.isReady(field)) return this.showField(field, range);
    this.overlays.say(`${values.fields[field].label} is being computed …`, "fine");
    values.load(field).then(
      () => this.chosen === name && this.showField(field, range),
      (error: unknown) => {
        if (this.chosen !== name) return;
        this.overlays.say(error instanceof Error ? error.message : String(error));
        shell.choices.field = this.field < 0 ? "" : values.fields[this.field].name;
        shell.display!.refresh();
      },
    );
  }

  /** Arrows are drawn when their components are there. */
  private async chooseArrows(name: string): Promise<void> {
    this.wanted ??= this.timeline?.index ?? 0;
    this.addressBar.changed();
    try {
      const loading = this.values.loadVectors(name);
      if (loading) this.overlays.say("Arrows are being computed …", "fine");
      await loading;
      if (loading) this.overlays.hush();
    } catch (error) {
      this.overlays.say(error instanceof Error ? error.message : String(error));
    }
    this.wanted ??= this.timeline.index;
  }

  private showField(field: number, range: [number, number] | null): void {
    this.field = field;
    this.overlays.hush();
    this.shell.setOwnRange(range);
    this.wanted = this.timeline.index;
    this.plots.probe(this.probed, this.field);
    this.addressBar.changed();
  }

  private showRange(): void {
    if (!this.timeline || this.field < 0) return;
    const { field } = this;
    this.shell.setFixedRange(
      this.rangeOverAll ? this.values.range(field) : this.values.rangeOfFrame(this.timeline.index, field),
    );
    this.addressBar.changed();
  }

  private tick(): Frame | null {
    if (!this.timeline) return null;
    this.timeline.tick();
    if (this.hasMoved && this.wanted === null) this.shell.pointAt(this.hovered);
    this.hasMoved = false;
    if (this.wanted === null) return null;
    const section = this.values.frame(this.wanted, this.field, this.swing, this.scale);
    section.arrows = this.values.arrows(this.wanted, this.shell.choices.arrows);
    const frame = this.body ? this.body.frame(section) : section;
    const viewport = this.shell.viewport!;
    viewport.setFrame(frame);
    if (this.field < 0) this.shell.bar.set(null, [0, 1], false);
    else this.showRange();
    const probes = this.probed === null ? [] : [new THREE.Vector3().fromArray(section.positions, 3 * this.probed)]; // in its plane
    viewport.marks.setProbes([...probes, ...this.showLine(frame)]);
    this.shell.pointAt(this.hovered);
    this.plots.mark(this.wanted);
    this.shell.inspected.frame = this.wanted;
    this.shell.inspected.swing = this.swing;
    this.shell.inspected.time = frame.time;
    this.shell.inspected.shownField = frame.field;
    this.wanted = null;
    return frame;
  }

  private view(): SharedView {
    return {
      frame: this.timeline.index,
      field: this.field < 0 ? "" : this.values.fields[this.field].name,
      camera: this.shell.viewport!.orbit.pose,
      look: this.shell.choices,
      range: this.shell.ownRange ?? undefined,
    };
  }

  private applyAddress(): void {
    const view = readAddress(location.hash);
    const { shell } = this;
    // Shapes of vibrations have no stress that means something: their size is arbitrary.
    const first = this.timeline.showsModes ? 0 : Math.min(1, this.values.fields.length - 1);
    if (location.hash === "") view.field = this.values.fields[first].name;
    const { revolve } = shell.choices;
    Object.assign(shell.choices, view.look);
    if (!this.values.recording.header.axisymmetric) shell.choices.revolve = 0;
    if (shell.choices.revolve !== revolve) this.resetScene();
    shell.choices.field = nameOfField(this.values.fields, view.field ?? "");
    if (!vectorFields(this.values.fields).some(({ name }) => name === shell.choices.arrows)) shell.choices.arrows = "";
    shell.display!.refresh();
    shell.viewport!.setLook(shell.choices);
    void this.chooseArrows(shell.choices.arrows);
    this.chooseField(shell.choices.field, view.range ?? null);
    if (view.camera) shell.lookFrom(view.camera);
    this.timeline.seek(view.frame ?? this.mostTelling(first));
  }

  /** The frame to begin with: the first mode that bends the body, or where the field is largest. */
  private mostTelling(field: number): number {
    const { frames } = this.values.recording;
    const modes = modesOf(frames, this.report);
    if (modes.length === 0) return this.values.mostTelling(field);
    const first = modes.findIndex((mode) => mode !== null && !mode.isRigid);
    return first >= 0 ? first : modes.length - 1;
  }

  private async share(): Promise<void> {
    this.addressBar.write();
    try {
      await navigator.clipboard.writeText(location.href);
      this.overlays.say("The link to this view is copied.", "fine");
    } catch {
      this.overlays.say("The address of this page now holds this view; copy it from the address bar.", "fine");
    }
  }

  /** The scene is played with from the frame that is shown. */
  private takeUp(): void {
    const { number } = this.values.recording.frames[this.timeline.index];
    if (this.takingUp!.frames.some((frame) => frame.number === number)) {
      this.addressBar.write(); // to which the browser's way back leads
      goTo(writeAddress({ ...this.view(), range: undefined, from: number }));
    } else this.overlays.say(`The state of frame ${number} is not in this page; select another one.`);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || belongsToControl(event)) return;
    const { timeline, shell } = this;
    const arrow = event.shiftKey ? null : arrowOf(event);
    const actions: Record<string, () => void> = {
      " ": () => timeline.toggle(),
      ArrowLeft: () => timeline.seek(timeline.index - 1),
      ArrowRight: () => timeline.seek(timeline.index + 1),
      Home: () => timeline.seek(0),
      End: () => timeline.seek(Infinity),
      f: () => shell.seeAll(),
      w: () => shell.toggle("wireframe"),
      c: () => shell.toggle("cells"),
      x: () => shell.toggle("cut"),
      m: () => shell.toggle("marks"),
      e: () => shell.toggle("edges"),
      o: () => shell.toggle("parallel"),
      l: () => this.toggleLine(),
      v: () => shell.recorder.toggle(),
      p: () => shell.takePicture(),
      ...(this.takingUp ? { t: () => this.takeUp() } : {}),
      "?": () => this.overlays.showHelp(!this.overlays.helpIsOpen),
      Enter: () => this.probeAtCrosshair(),
      Escape: () => this.leaveProbe(),
    };
    if (movesCamera(event, shell.viewport!.orbit)) shell.viewport!.touch();
    else if (arrow && this.crosshair.isShown) {
      this.crosshair.move(arrow);
      this.click(this.crosshair.place);
    } else {
      const action = actions[keyOf(event)];
      if (!action) return;
      action();
    }
    event.preventDefault();
    this.addressBar.changed();
  }

  private probeAtCrosshair(): void {
    if (!this.crosshair.isShown) this.crosshair.show(this.shell.middleOfBody());
    this.click(this.crosshair.place);
  }

  private leaveProbe(): void {
    this.crosshair.hide();
    this.probe(null);
  }
}
