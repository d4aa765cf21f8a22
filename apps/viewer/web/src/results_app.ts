/** The page of recorded results. */

import { AddressBar, readAddress, type SharedView } from "./address";
import { element, iconButton } from "./dom";
import { Gestures, type Place } from "./gestures";
import { Overlays } from "./overlays";
import { Plots } from "./plots";
import type { Frame } from "./protocol";
import type { RecordedValues } from "./recorded_values";
import type { Recording } from "./recording";
import type { Report } from "./report";
import { Shell } from "./shell";
import { Timeline } from "./timeline";
import * as THREE from "three";

const KEYS: [string, string][] = [
  ["left button", "turn the camera; a click on the body shows the values there"],
  ["middle button, Shift and left button", "move the camera"],
  ["wheel, two fingers", "come nearer, go away"],
  ["Space", "play and pause"],
  ["← →", "the frame before, the next one"],
  ["Home End", "the first frame, the last one"],
  ["f", "see the whole scene"],
  ["w c x", "wireframe, coarse cells, cut"],
  ["Escape", "forget the probed place"],
  ["?", "this help"],
];

export class ResultsApp {
  private readonly shell: Shell;
  private readonly overlays = new Overlays(KEYS);
  private readonly timeline: Timeline;
  private readonly plots: Plots;
  private field = -1;
  private chosen = ""; // name of the field that is shown, or will be once it is there
  private wanted: number | null = 0; // frame to be drawn next
  private probed: number | null = null;
  private rangeOverAll = true;
  private readonly addressBar = new AddressBar(() => (this.timeline.isPlaying ? null : this.view()));

  constructor(
    private readonly values: RecordedValues,
    report: Report | null,
  ) {
    const { recording } = values;
    this.shell = new Shell("recorded", this.overlays, {
      fieldChosen: (name) => this.chooseField(name),
      themeChanged: () => this.plots?.redraw(),
      rangeChanged: () => this.showRange(),
      tick: () => this.tick(),
      drawn: () => {},
    });
    const header = { ...recording.header, fields: values.fields };
    const viewport = this.shell.setScene(header, recording.topology, (part) =>
      header.parts[part].kind === "skin" ? "smooth" : "creased",
    );
    viewport.setGround(header.ground ?? null);
    viewport.seeAll();
    this.shell.addDisplay({
      look: () => this.addressBar.changed(),
      rangeOver: (choice) => {
        this.rangeOverAll = choice === "all frames";
        this.showRange();
      },
    });
    this.timeline = new Timeline(
      recording.frames,
      (index) => {
        this.wanted = index;
        this.addressBar.changed();
      },
      () => void this.share(),
    );
    this.plots = new Plots(values, report, (index) => this.timeline.seek(index));
    this.shell.bottom.append(this.timeline.root);
    this.shell.panelPlace.append(this.plots.root);
    this.shell.left.append(
      element(
        "nav",
        { class: "card toolbar small" },
        iconButton("plots", "Plots", () => (this.plots.root.hidden = !this.plots.root.hidden)),
        iconButton("help", "Mouse and keys (?)", () => this.overlays.showHelp(true)),
      ),
    );
    if (matchMedia("(max-width: 720px)").matches) this.plots.root.hidden = true;
    this.describe(recording, report);
    this.listen();
    this.applyAddress();
    const { inspected } = this.shell;
    Object.assign(inspected, {
      header,
      report,
      seek: (index: number) => this.timeline.seek(index),
      probe: (vertex: number) => this.probe(vertex),
    });
  }

  private describe(recording: Recording, report: Report | null): void {
    const words: string[] = [];
    const { frames, skipped, damage } = recording;
    words.push(frames.length === 1 ? "one frame" : `${frames.length} frames`);
    if (skipped > 0) words.push(`every ${skipped + 1}th of what was recorded, since all would not fit`);
    if (report && report.status !== "done") words.push(report.reason || report.status);
    if (damage) words.push(damage);
    const warnings = report?.warnings ?? [];
    words.push(...warnings);
    this.shell.subtitle.append(` · ${words.join(" · ")}`);
    if (damage || warnings.length > 0 || (report && report.status !== "done"))
      this.shell.subtitle.classList.add("warn");
  }

  private listen(): void {
    new Gestures(this.shell.canvas, () => this.shell.viewport!.orbit, {
      press: () => false,
      drag: () => {},
      release: () => {},
      click: (at) => this.click(at),
      hover: () => {},
      cameraMoved: () => {
        this.shell.viewport!.touch();
        this.addressBar.changed();
      },
    });
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("hashchange", () => this.applyAddress());
  }

  private click(at: Place): void {
    const hit = this.shell.viewport!.pickAt(at.x, at.y);
    if (hit) this.probe(hit.vertex);
  }

  private probe(vertex: number | null): void {
    this.probed = vertex;
    this.plots.probe(vertex, this.field);
    if (vertex !== null) this.plots.root.hidden = false;
    this.wanted ??= this.timeline.index;
    this.shell.inspected.probed = vertex;
  }

  /** What has to be computed first is shown when it is there, unless something else was chosen meanwhile. */
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
    if (this.wanted === null) return null;
    const frame = this.values.frame(this.wanted, this.field);
    const viewport = this.shell.viewport!;
    viewport.setFrame(frame);
    if (this.field < 0) this.shell.bar.set(null, [0, 1], false);
    else this.showRange();
    viewport.marks.setProbes(
      this.probed === null ? [] : [new THREE.Vector3().fromArray(frame.positions, 3 * this.probed)],
    );
    this.plots.mark(this.wanted);
    this.shell.inspected.frame = this.wanted;
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
    if (location.hash === "") view.field = this.values.fields[Math.min(1, this.values.fields.length - 1)].name;
    Object.assign(shell.choices, view.look);
    shell.choices.field = this.values.fields.some((field) => field.name === view.field) ? view.field! : "";
    shell.display!.refresh();
    shell.viewport!.setLook(shell.choices);
    this.chooseField(shell.choices.field, view.range ?? null);
    if (view.camera) shell.viewport!.orbit.setPose(view.camera);
    this.timeline.seek(view.frame ?? this.values.recording.frames.length - 1);
  }

  private async share(): Promise<void> {
    this.addressBar.write();
    try {
      await navigator.clipboard.writeText(location.href);
      this.overlays.say("The link to this view is copied.", "fine");
    } catch {
      this.overlays.say("The address of this page now shows this view; copy it from the address bar.", "fine");
    }
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const inField = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
    if (inField && !(event.key === " " && (event.target as HTMLInputElement).type === "range")) return;
    const { timeline, shell } = this;
    const actions: Record<string, () => void> = {
      " ": () => timeline.toggle(),
      ArrowLeft: () => timeline.seek(timeline.index - 1),
      ArrowRight: () => timeline.seek(timeline.index + 1),
      Home: () => timeline.seek(0),
      End: () => timeline.seek(Infinity),
      f: () => shell.viewport!.seeAll(),
      w: () => shell.toggle("wireframe"),
      c: () => shell.toggle("cells"),
      x: () => shell.toggle("cut"),
      "?": () => this.overlays.showHelp(!this.overlays.helpIsOpen),
      Escape: () => (this.overlays.helpIsOpen ? this.overlays.showHelp(false) : this.probe(null)),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
    this.addressBar.changed();
  }
}
