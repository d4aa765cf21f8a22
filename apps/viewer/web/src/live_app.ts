/** The page of a live scene. */

import { AddressBar, nameOfField, readAddress, type SharedView, writeAddress } from "./address";
import { element, icon, iconButton } from "./dom";
import { Crosshair } from "./crosshair";
import { Gestures, type Place } from "./gestures";
import { HeadUp } from "./head_up";
import { LiveLine } from "./live_line";
import { History } from "./history";
import { arrowOf, belongsToControl, CAMERA_KEYS, keyOf, movesCamera } from "./keys";
import { LiveConnection } from "./live";
import { LivePanel, type LiveActions } from "./live_panel";
import { Opener } from "./opener";
import { Overlays } from "./overlays";
import type { ControlValue, Frame, Hello, PageMessage, State, Topology } from "./protocol";
import { Shell } from "./shell";
import { vectorFields } from "./vectors";
import type { Viewport } from "./viewport";
import { Strip } from "./strip";
import { goTo, type WordsOfStart } from "./taking_up";
import { Tools, type Tool } from "./tools";
import type { Scenery } from "./transport";

const KEYS: [string, string][] = [
  ["left button on the body", "the current tool: drag, pin, poke, fix or load a face"],
  ["left button beside it, right button", "rotate the camera"],
  ["middle button, Shift and left button", "pan the camera"],
  ["wheel, two fingers", "zoom"],
  ...CAMERA_KEYS,
  ["arrows, Enter", "move the pointer on the body; apply the tool, release"],
  ["1 2 3 4 5", "hand, pin, poke, fix a face, load a face (a second click undoes it)"],
  ["Ctrl z", "undo"],
  ["q", "solve for the equilibrium"],
  ["Ctrl s", "save the scene with its fixed faces"],
  ["Ctrl o, a file dropped", "open a mesh or a surface"],
  ["v p", "record a film; save a picture with a transparent background"],
  ["Space", "pause and continue"],
  ["s", "single step"],
  ["r", "reset to the start"],
  ["f", "fit the view to the scene"],
  ["l", "plot the field along a line between two clicks; again: remove it"],
  ["w e c x m o", "wireframe, edges, coarse cells, section cut, boundary conditions and loads, orthographic view"],
  ["?", "this help"],
];

const ONE_CHANGE = 1500; // [ms] within which changes of a control are one
const ofBody = (body: number | undefined) => (body === undefined ? {} : { body });
const KEY_STEP = 14; // pixels that an arrow leads what is held
const HOVER_LIMIT = 40_000; // triangles up to which the pointer's look follows what is below it

export class LiveApp {
  private readonly shell: Shell;
  private readonly connection: LiveConnection;
  private readonly headUp = new HeadUp();
  private readonly strip = new Strip();
  private readonly line = new LiveLine();
  private readonly overlays = new Overlays(KEYS);
  private readonly crosshair = new Crosshair();
  private readonly toolButtons = new Map<Tool, HTMLButtonElement>();
  private readonly pauseButton: HTMLButtonElement;
  private readonly saveButton = iconButton("save", "Save the scene with its fixed faces (Ctrl s)", () =>
    this.connection.send({ type: "save" }),
  );
  private readonly lineButton = iconButton("line", "Plot the field along a line (l)", () => this.toggleLine());
  private readonly opener: Opener;
  private readonly history = new History();
  private panel: LivePanel | null = null;
  private tools: Tools | null = null;
  private tool: Tool = "hand";
  private state: State | null = null;
  private client = 0; // how the program calls this page
  private readonly unsent = new Map<string, { key: string; value: ControlValue; body?: number }>(); // by key and body
  private hovered: Place | null = null;
  private isFirstScene = true;
  private restarts = 0; // how often time went back
  private readonly addressBar = new AddressBar(() => this.view());

  /** `start`: of a recorded scene, where it was taken up. */
  constructor(
    scenery: Scenery,
    private readonly start: WordsOfStart | null = null,
  ) {
    this.connection = new LiveConnection(scenery, {
      scene: (hello, topology) => this.setScene(hello, topology),
      state: (state) => this.setState(state),
      status: (status) => {
        this.headUp.set(status);
        if (status.drives) this.panel?.followDrives(status.drives);
        this.strip.add(status);
        this.shell.inspected.status = status;
        if (this.tools) this.tools.force = status.hand_force ?? null;
      },
      refused: (message) => {
        this.overlays.say(message);
        this.panel?.restore();
      },
      told: (message) => this.overlays.say(message, "fine"),
      lost: (words) => {
        this.tools?.letGo();
        this.overlays.showLost(words);
      },
      found: () => this.overlays.showLost(null),
    });
    this.shell = new Shell("live", this.overlays, {
      fieldChosen: (name) => this.chooseField(name),
      arrowsChosen: () => this.sendField(),
      themeChanged: () => {
        this.strip.redraw();
        this.line.redraw();
      },
      cameraMoved: () => this.addressBar.changed(),
      rangeChanged: (range) => range === null && this.shell.forgetRange(),
      tick: () => this.tick(),
      drawn: (frame) => this.connection.acknowledge(frame),
    });
    this.opener = new Opener(scenery.send, this.overlays);
    this.pauseButton = iconButton("pause", "Pause (Space)", () => this.togglePause());
    this.overlays.root.append(this.crosshair.root);
    this.shell.bottom.append(this.toolbar(), this.headUp.root);
    this.shell.left.append(this.line.root, this.strip.root);
    new Gestures(this.shell.canvas, () => this.shell.viewport!.orbit, {
      press: (at) => {
        this.crosshair.hide();
        return this.line.isAsking ? false : (this.tools?.press(at) ?? false);
      },
      drag: (at) => this.tools?.drag(at),
      release: () => this.tools?.release(),
      click: (at) => (this.line.isAsking ? this.clickLine(at) : this.tools?.click(at)),
      hover: (at) => {
        this.hovered = at;
        if (at === null) this.shell.pointAt(null);
      },
      cameraMoved: () => {
        this.shell.viewport?.touch();
        this.addressBar.changed();
      },
    });
    addEventListener("keydown", (event) => this.key(event));
    if (start)
      addEventListener("hashchange", () => readAddress(location.hash).from !== start.from && location.reload());
    Object.assign(this.shell.inspected, {
      connection: this.connection,
      send: (message: PageMessage) => this.connection.send(message),
      held: () => this.tools?.held ?? null,
    });
    this.connection.connect();
  }

  private view(): SharedView {
    const { choices, viewport } = this.shell;
    const shown = readAddress(location.hash);
    const frame = this.start ? { frame: shown.frame, from: this.start.from } : {};
    return { ...frame, field: choices.field, camera: viewport!.orbit.pose, look: choices };
  }

  /** To the recording that the scene was taken up from. */
  private goBack(): void {
    goTo(writeAddress({ ...this.view(), from: undefined }));
  }

  private toolbar(): HTMLElement {
    const bar = element("nav", { class: "card toolbar", "aria-label": "tools" });
    const group = (...buttons: HTMLElement[]) => bar.append(element("div", { class: "group" }, ...buttons));
    const names: [Tool, string][] = [
      ["hand", "Hand: drag the body (1)"],
      ["pin", "Pin: fix a point where it is (2)"],
      ["poke", "Poke: push with a ball (3)"],
      ["hold", "Fix: a click on a face fixes it, a second click releases it (4)"],
      ["load", "Load: a click applies a force or a pressure to a face, a second click removes it (5)"],
    ];
    for (const [tool, label] of names) {
      const button = iconButton(tool, label, () => this.chooseTool(tool));
      button.setAttribute("aria-pressed", String(tool === this.tool));
      this.toolButtons.set(tool, button);
    }
    group(...this.toolButtons.values());
    group(
      this.pauseButton,
      iconButton("step", "Single step (s)", () => this.connection.send({ type: "step" })),
      iconButton("settle", "Solve for the equilibrium (q)", () => this.connection.send({ type: "settle" })),
      iconButton("reset", "Reset (r)", () => this.connection.send({ type: "reset" })),
      iconButton("undo", "Undo (Ctrl z)", () => this.undo()),
    );
    group(
      this.start
        ? iconButton("back", "Back to the recording (b)", () => this.goBack())
        : iconButton("open", "Open a mesh or a surface (Ctrl o)", () => this.opener.choose()),
      this.saveButton,
      this.lineButton,
      ...this.shell.cameraButtons,
      iconButton("help", "Mouse and keys (?)", () => this.overlays.showHelp(true)),
    );
    return bar;
  }

  private setScene(hello: Hello, topology: Topology): void {
    // Skins come with normals; the surface of cells gets creases where the body has edges.
    const viewport = this.shell.setScene(hello, topology, (part) =>
      hello.parts[part].kind === "skin" ? "given" : "creased",
    );
    this.client = hello.client;
    this.line.setScene(topology, hello.dimension === 2);
    this.lineButton.setAttribute("aria-pressed", "false");
    this.saveButton.hidden = !hello.saves;
    this.history.clear();
    this.tools = new Tools(viewport, this.connection, this.history, Number(hello.state.values.max_force) || 1);
    this.tools.tool = this.tool;
    const actions: LiveActions = {
      set: (key, value, body, before) => {
        const label = hello.controls.find((control) => control.key === key)?.label ?? key;
        this.noteChange(`${key} ${body ?? ""}`, label, { type: "set", key, value: before, ...ofBody(body) });
        this.unsent.set(`${key} ${body ?? ""}`, { key, value, ...ofBody(body) });
      },
      send: (message) => {
        this.noteRemoval(message);
        this.connection.send(message);
      },
      complain: (words) => this.overlays.say(words),
    };
    this.panel = new LivePanel(this.shell.gui!, hello, actions, this.tools);
    const back: [string, string][] = this.start ? [["b", "back to the recording"]] : [];
    this.overlays.setKeys([...KEYS, ...this.panel.hotkeys, ...back]);
    this.panel.setState(hello.state);
    this.shell.warnings.set(hello.state.warnings);
    this.headUp.setDimension(hello.dimension);
    this.strip.setDimension(hello.dimension);
    this.shell.addBodies(
      (body) => this.panel?.chooseBody(body),
      () => {},
    );
    const { choices } = this.shell;
    viewport.setGround(hello.state.ground);
    if (!this.shell.cameraWasKept) this.shell.seeAll();
    if (this.isFirstScene) this.applyAddress(viewport);
    if (this.start) this.describe(this.start);
    this.isFirstScene = false;
    choices.field = nameOfField(hello.fields, choices.field);
    if (!vectorFields(hello.fields).some(({ name }) => name === choices.arrows)) choices.arrows = "";
    viewport.setLook(choices);
    this.shell.addDisplay({ look: () => this.addressBar.changed() });
    this.shell
      .display!.folder.add({ visible: true }, "visible")
      .name("Curves")
      .onChange((visible: boolean) => (this.strip.root.hidden = !visible));
    this.chooseField(choices.field);
    this.shell.inspected.header = hello;
  }

  /** The next two clicks are the ends of a line; without a field the stress is shown. */
  private toggleLine(): void {
    const words = this.line.toggle();
    this.lineButton.setAttribute("aria-pressed", String(this.line.isOn));
    if (words) this.overlays.say(words, "fine");
    const { choices, viewport, display } = this.shell;
    if (this.line.isOn && choices.field === "" && viewport) {
      this.chooseField(nameOfField(viewport.header.fields, "von_mises"));
      display!.refresh();
    }
    viewport?.marks.setProbes([]);
    viewport?.touch();
  }

  private clickLine(at: Place): void {
    const hit = this.shell.viewport!.pickAt(at.x, at.y);
    if (hit && this.line.add(hit)) this.overlays.say("Now click where the line ends.", "fine");
  }

  /** A slider that is drawn gives one entry, not one for each of its places. */
  private noteChange(place: string, label: string, back: PageMessage): void {
    const now = performance.now();
    const goesOn = this.lastChange.place === place && now - this.lastChange.at < ONE_CHANGE;
    this.lastChange = { place, at: now };
    if (!goesOn) this.history.add(label, back);
  }

  private lastChange = { place: "", at: 0 };

  /** Actions of the panel's buttons can be undone. */
  private noteRemoval({ type }: PageMessage): void {
    if (type === "unpin_all" && this.state)
      this.history.add("all pins", ...this.state.pinned.map((vertex): PageMessage => ({ type: "pin", vertex })));
    if (type === "free_faces") this.tools?.noteAllRemoved("hold", "all fixed faces");
    if (type === "remove_loads") this.tools?.noteAllRemoved("load", "all loads on faces");
  }

  private undo(): void {
    const deed = this.history.take();
    this.lastChange.place = "";
    if (!deed) return this.overlays.say("There is nothing to undo.", "fine");
    deed.messages.forEach((message) => this.connection.send(message));
    this.overlays.say(`Undone: ${deed.what}.`, "fine");
  }

  private describe({ heading, notes }: WordsOfStart): void {
    this.shell.subtitle.append(` · ${[heading, ...notes].join(" · ")}`);
  }

  /** Applies the view of the address, as after the page was loaded again. */
  private applyAddress(viewport: Viewport): void {
    const view = readAddress(location.hash);
    const { choices } = this.shell;
    Object.assign(choices, view.look, { field: view.field ?? "" });
    viewport.setLook(choices);
    if (view.camera) this.shell.lookFrom(view.camera);
  }

  private setState(state: State): void {
    this.state = state;
    this.shell.inspected.state = state;
    this.panel?.setState(state);
    this.tools?.setState(state, this.client);
    this.shell.viewport?.setGround(state.ground);
    const name = state.paused ? "play" : "pause";
    if (this.pauseButton.dataset.shows !== name) {
      this.pauseButton.dataset.shows = name;
      this.pauseButton.replaceChildren(icon(name));
      this.pauseButton.title = state.paused ? "Continue (Space)" : "Pause (Space)";
    }
  }

  private chooseField(name: string): void {
    this.shell.forgetRange();
    this.shell.choices.field = name;
    this.sendField();
  }

  /** Tells the program what frames are to hold; the page forms displacements itself. */
  private sendField(): void {
    const { field: name, arrows } = this.shell.choices;
    this.addressBar.changed();
    this.connection.send({ type: "field", name, ...(arrows === "" || arrows === "displacement" ? {} : { arrows }) });
  }

  private chooseTool(tool: Tool): void {
    this.tool = tool;
    if (this.tools) this.tools.tool = tool;
    this.toolButtons.forEach((button, name) => button.setAttribute("aria-pressed", String(name === tool)));
    this.shell.inspected.tool = tool;
  }

  private togglePause(): void {
    this.connection.send({ type: this.state?.paused ? "play" : "pause" });
  }

  private tick(): Frame | null {
    for (const change of this.unsent.values()) this.connection.send({ type: "set", ...change });
    this.unsent.clear();
    const frame = this.connection.takeFrame();
    if (frame) {
      this.shell.viewport!.setFrame(frame);
      this.shell.followRange(frame, true);
      if (frame.time < (this.shell.inspected.time as number)) ++this.restarts;
      Object.assign(this.shell.inspected, { time: frame.time, restarts: this.restarts });
      this.shell.inspected.shownField = frame.field;
    }
    if (this.line.isOn) this.showLine();
    this.tools?.beforeDraw();
    this.showHover();
    return frame;
  }

  private showLine(): void {
    const { viewport } = this.shell;
    if (!viewport?.frame) return;
    const field = viewport.header.fields[viewport.frame.field] ?? null;
    const ends = this.line.update(viewport.frame, field);
    if (!ends) return;
    viewport.marks.setProbes(ends);
    viewport.touch();
    this.shell.inspected.line = this.line.values;
  }

  private showHover(): void {
    if (!this.hovered || !this.shell.viewport || this.shell.viewport.triangleCount() > HOVER_LIMIT) return;
    const { x, y } = this.hovered;
    this.shell.pointAt(this.hovered);
    this.hovered = null;
    this.shell.canvas.dataset.over = this.shell.viewport.pickAt(x, y) ? this.tool : "";
  }

  private key(event: KeyboardEvent): void {
    if (this.isCommand(event)) return event.preventDefault();
    if (event.ctrlKey || event.metaKey || event.altKey || belongsToControl(event)) return;
    const { shell } = this;
    const actions: Record<string, () => void> = {
      "1": () => this.chooseTool("hand"),
      "2": () => this.chooseTool("pin"),
      "3": () => this.chooseTool("poke"),
      "4": () => this.chooseTool("hold"),
      "5": () => this.chooseTool("load"),
      q: () => this.connection.send({ type: "settle" }),
      " ": () => this.togglePause(),
      s: () => this.connection.send({ type: "step" }),
      r: () => this.connection.send({ type: "reset" }),
      f: () => shell.seeAll(),
      w: () => shell.toggle("wireframe"),
      c: () => shell.toggle("cells"),
      l: () => this.toggleLine(),
      x: () => shell.toggle("cut"),
      m: () => shell.toggle("marks"),
      e: () => shell.toggle("edges"),
      o: () => shell.toggle("parallel"),
      v: () => shell.recorder.toggle(),
      p: () => shell.takePicture(),
      ...(this.start ? { b: () => this.goBack() } : {}),
      "?": () => this.overlays.showHelp(!this.overlays.helpIsOpen),
      Enter: () => this.actAtCrosshair(),
      Escape: () => this.leaveCrosshair(),
    };
    const action = actions[keyOf(event)] ?? this.panel?.hotkeyAction(keyOf(event));
    if (action) action();
    else if (shell.viewport && movesCamera(event, shell.viewport.orbit)) shell.viewport.touch();
    else if (!this.moveCrosshair(arrowOf(event))) return;
    event.preventDefault();
    this.addressBar.changed();
  }

  /** Ctrl and a letter, as in every program; true when it was one of ours. */
  private isCommand(event: KeyboardEvent): boolean {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.shiftKey) return false;
    const command = this.commands[keyOf(event)];
    command?.();
    return command !== undefined;
  }

  private readonly commands: Record<string, () => void> = {
    s: () => this.connection.send({ type: "save" }),
    o: () => this.opener.choose(),
    z: () => this.undo(),
  };

  /** Arrows lead what is held, else they move the crosshair, which begins on the body. */
  private moveCrosshair(arrow: [number, number] | null): boolean {
    if (!arrow) return false;
    if (!this.crosshair.isShown) this.crosshair.show(this.shell.middleOfBody());
    else if (this.tools?.isHolding) this.tools.nudge(KEY_STEP * arrow[0], KEY_STEP * arrow[1]);
    else this.crosshair.move(arrow);
    return true;
  }

  private actAtCrosshair(): void {
    if (!this.tools) return;
    if (this.tools.isHolding) return this.tools.release();
    if (!this.crosshair.isShown) this.crosshair.show(this.shell.middleOfBody());
    if (this.tools.clicks) return this.tools.click(this.crosshair.place);
    if (!this.tools.press(this.crosshair.place)) this.overlays.say("No body under the cross.");
  }

  private leaveCrosshair(): void {
    if (this.tools?.isHolding) this.tools.release();
    else this.crosshair.hide();
  }
}
