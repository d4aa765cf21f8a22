/** The hand, the pin, the ball and the holding of faces: what a press on the body does in a live scene. */

import * as THREE from "three";
import type { Place } from "./gestures";
import type { LiveConnection } from "./live";
import { placeOf, type Hit } from "./picking";
import { perDepth, withUnit } from "./numbers";
import type { History } from "./history";
import type { PageMessage, State } from "./protocol";
import type { Viewport } from "./viewport";

export type Tool = "hand" | "pin" | "poke" | "hold" | "load";

type FaceMessage = Extract<PageMessage, { type: "hold" | "load" }>;

/** A click on a face, and where on the body it was. */
interface Touch {
  hit: Hit;
  message: FaceMessage;
}

const PIN_REACH = 14; // pixels within which a click means a pin that is there

export class Tools {
  tool: Tool = "hand";
  pokeRadius: number;
  faceAngle = 30; // [degrees] largest angle of a fixed face to the clicked point
  faceRadius = 0; // [m] that it reaches from there; 0: as far as it goes
  loadKind: "force" | "pressure" = "force";
  loadForce: number; // [N], in 2D [N/m]
  loadPressure = 1000; // [Pa]
  private grab: Hit | null = null;
  private poking = false;
  private readonly target = new THREE.Vector3();
  private readonly plane = new THREE.Plane();
  private unsent = false;
  private pinned: number[] = [];
  private lastTouch: Touch | null = null; // until the program shows its face
  private touches: Record<FaceMessage["type"], Map<string, Touch>> = { hold: new Map(), load: new Map() }; // by vertices
  private restored: Record<FaceMessage["type"], Touch[]> = { hold: [], load: [] }; // by undo, not yet shown
  private readonly grabbed = new THREE.Vector3();

  constructor(
    readonly viewport: Viewport,
    private readonly connection: LiveConnection,
    private readonly history: History,
    handForce: number, // [N] that is much for these bodies
  ) {
    this.loadForce = Number((0.2 * handForce).toPrecision(2)) || 1;
    this.pokeRadius = Number((0.1 * viewport.extent).toPrecision(2));
  }

  get held(): Hit | null {
    return this.grab;
  }

  /** Whether the tool works by clicks, not by pulling. */
  get clicks(): boolean {
    return this.tool === "pin" || this.tool === "hold" || this.tool === "load";
  }

  press(at: Place): boolean {
    if (this.clicks) return false;
    const hit = this.viewport.pickAt(at.x, at.y);
    if (!hit) return false;
    const towardsEye = this.viewport.orbit.axis(2);
    this.plane.setFromNormalAndCoplanarPoint(towardsEye, hit.point);
    this.target.copy(hit.point);
    if (this.tool === "hand") {
      this.grab = hit;
      this.connection.send({ type: "grab", vertex: hit.vertex, point: hit.point.toArray() });
    } else {
      this.poking = true;
      // The ball comes from the eye's side and reaches half its radius into the body.
      if (!this.viewport.flat) this.target.addScaledVector(towardsEye, 0.5 * this.pokeRadius);
      this.plane.setFromNormalAndCoplanarPoint(towardsEye, this.target);
      this.unsent = true;
    }
    this.viewport.touch();
    return true;
  }

  drag(at: Place): void {
    if (!this.grab && !this.poking) return;
    const met = this.viewport.orbit.ray(at.x, at.y).intersectPlane(this.plane, new THREE.Vector3());
    if (!met) return;
    this.target.copy(met);
    this.unsent = true;
    this.viewport.touch();
  }

  /** By keys: what is held goes on by so many pixels of the window. */
  nudge(dx: number, dy: number): void {
    if (!this.isHolding) return;
    const { x, y } = this.viewport.orbit.project(this.target);
    this.drag({ x: x + dx, y: y + dy });
  }

  get isHolding(): boolean {
    return this.grab !== null || this.poking;
  }

  /** How strongly the program says that the hand pulls [N]; null: it holds nothing. */
  force: number | null = null;

  release(): void {
    if (this.grab) this.connection.send({ type: "release" });
    if (this.poking) this.connection.send({ type: "poke_end" });
    this.letGo();
  }

  /** Forgets what is held without a word to the program. */
  letGo(): void {
    this.grab = null;
    this.poking = this.unsent = false;
    this.viewport.marks.setHand(null, null);
    this.viewport.marks.setPoke(null, 0);
    this.viewport.labels.set("hand", "", null, "hand");
    this.force = null;
    this.viewport.touch();
  }

  click(at: Place): void {
    if (!this.clicks || !this.viewport.frame) return;
    if (this.tool === "hold") return this.holdFace(at);
    if (this.tool === "load") return this.loadFace(at);
    const near = this.pinned.find((vertex) => {
      const seen = this.viewport.orbit.project(this.vertexPlace(vertex));
      return Math.hypot(seen.x - at.x, seen.y - at.y) < PIN_REACH;
    });
    if (near !== undefined) {
      this.history.add("removal of a pin", { type: "pin", vertex: near });
      return this.connection.send({ type: "unpin", vertex: near });
    }
    const hit = this.viewport.pickAt(at.x, at.y);
    if (!hit) return;
    this.history.add("a pin", { type: "unpin", vertex: hit.vertex });
    this.connection.send({ type: "pin", vertex: hit.vertex });
  }

  /** The program holds the face around the place, or frees it where it is held. */
  private holdFace(at: Place): void {
    const hit = this.viewport.pickAt(at.x, at.y);
    if (!hit) return;
    const { faceAngle: angle, faceRadius: radius } = this;
    const message: FaceMessage = { type: "hold", vertex: hit.vertex, point: hit.point.toArray(), angle, radius };
    this.history.add("a fixed face", message); // a second time frees it
    this.lastTouch = { hit, message };
    this.connection.send(message);
  }

  /** A force or a pressure on the face around the place; a second one there takes it away. */
  private loadFace(at: Place): void {
    const hit = this.viewport.pickAt(at.x, at.y);
    if (!hit) return;
    const { faceAngle: angle, faceRadius: radius, loadKind: kind } = this;
    const value = kind === "force" ? this.loadForce : this.loadPressure;
    const message: FaceMessage = {
      type: "load",
      vertex: hit.vertex,
      point: hit.point.toArray(),
      angle,
      radius,
      kind,
      value,
    };
    this.history.add("a load on a face", message);
    this.lastTouch = { hit, message };
    this.connection.send(message);
  }

  /** Undo puts back the faces that were clicked on this page, at their places on the body by then. */
  noteAllRemoved(type: FaceMessage["type"], what: string): void {
    const touches = [...this.touches[type].values()];
    if (touches.length === 0) return;
    const { viewport } = this;
    const again = ({ hit, message }: Touch): FaceMessage => ({
      ...message,
      point: placeOf(hit, viewport.frame!.positions, new THREE.Vector3()).toArray(),
    });
    this.history.addLater(what, () => {
      this.restored[type] = [...touches];
      return touches.map(again);
    });
  }

  /** Keeps the clicks of faces that are there; a face that is new is that of the last click. */
  private followFaces(type: FaceMessage["type"], faces: { vertices: number[] }[]): void {
    const known = this.touches[type];
    const present = new Map<string, Touch>();
    for (const key of faces.map(({ vertices }) => vertices.join())) {
      const touch = known.get(key) ?? this.restored[type].shift() ?? this.takeLastTouch(type);
      if (touch) present.set(key, touch);
    }
    this.touches[type] = present;
  }

  private takeLastTouch(type: FaceMessage["type"]): Touch | null {
    const touch = this.lastTouch;
    if (touch?.message.type !== type) return null;
    this.lastTouch = null;
    return touch;
  }

  setState(state: State, client: number): void {
    this.followFaces("hold", state.held);
    this.followFaces("load", state.loads ?? []);
    this.pinned = state.pinned;
    this.viewport.setHeld(state.held.flatMap(({ vertices }) => vertices));
    this.viewport.setLoads(state.loads ?? []);
    const takenAway = this.grab && state.grabbed_by !== null && state.grabbed_by !== client;
    if (takenAway) this.letGo();
    this.viewport.touch();
  }

  /** Once per drawn frame: one message at most, and the marks where they belong. */
  beforeDraw(): void {
    if (this.unsent) {
      this.unsent = false;
      if (this.grab) this.connection.drag(this.target);
      if (this.poking) this.connection.send({ type: "poke", center: this.target.toArray(), radius: this.pokeRadius });
    }
    const { frame, marks } = this.viewport;
    if (!frame) return;
    if (this.grab) {
      marks.setHand(this.target, placeOf(this.grab, frame.positions, this.grabbed));
      const words = this.force === null ? "" : withUnit(this.force, perDepth("N", this.viewport.header.dimension));
      this.viewport.labels.set("hand", words, words ? this.target : null, "hand");
    }
    if (this.poking) marks.setPoke(this.target, this.pokeRadius);
    marks.setPins(this.pinned.map((vertex) => this.vertexPlace(vertex)));
  }

  private vertexPlace(vertex: number): THREE.Vector3 {
    return new THREE.Vector3().fromArray(this.viewport.frame!.positions, 3 * vertex);
  }
}
