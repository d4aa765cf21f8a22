/** Everything that is drawn in 3D: bodies, ground, the hand's marks; drawn anew only when something has changed. */

import * as THREE from "three";
import { sceneUniforms } from "./body_shader";
import { Colliders } from "./colliders";
import { Connectors } from "./connectors";
import { Ground } from "./ground";
import { Marks } from "./marks";
import { Orbit } from "./orbit";
import { pick, type Hit } from "./picking";
import { Labels } from "./labels";
import type { Frame, Header, Topology, Vector } from "./protocol";
import { FaceLoads, HeldMarks, SceneMarks } from "./scene_marks";
import { Section } from "./section";
import { hasSharpEdges, LINES, Surface, type Normals } from "./surface";
import { colorTexture, type ColorMap } from "./color_map";
import type { BodyLook } from "./bodies";
import { Vectors } from "./vectors";

/** Body colours, sRGB: flesh, then calm companions. */
export const BODY_COLORS = [0xe39a80, 0x7fa8c9, 0xd9b36c, 0x86b39a, 0xb79ac8, 0xc98d8d];

export interface Look {
  wireframe: boolean;
  edges: boolean; // those of the body's shape
  parallel: boolean; // lines of sight
  arrows: string; // name of the field whose vectors are drawn; "": none
  colorMap: ColorMap;
  cells: boolean;
  ground: boolean;
  colliders: boolean;
  marks: boolean; // supports, loads and probes
  cut: boolean;
  cutAxis: "x" | "y" | "z";
  cutAt: number; // share of the box, 0 to 1
  cutFlip: boolean;
  revolve: number; // angle through which a half section is turned [degrees]; 0: not
}

export const defaultLook = (): Look => ({
  wireframe: false,
  edges: true,
  parallel: false,
  arrows: "",
  colorMap: "viridis",
  cells: false,
  ground: true,
  colliders: true,
  marks: true,
  cut: false,
  cutAxis: "x",
  cutAt: 0.5,
  cutFlip: false,
  revolve: 0,
});

const MOST_TRIANGLES_WITH_EDGES = 400_000;

/** Margins of the window that are covered, from each side [pixels]. */
export interface Covered {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

export function joined(lists: Uint32Array[]): Uint32Array {
  const all = new Uint32Array(lists.reduce((sum, list) => sum + list.length, 0));
  let end = 0;
  for (const list of lists) {
    all.set(list, end);
    end += list.length;
  }
  return all;
}

export class Viewport {
  readonly renderer: THREE.WebGLRenderer;
  readonly orbit: Orbit;
  readonly marks: Marks;
  readonly colliders: Colliders;
  readonly uniforms = sceneUniforms();
  readonly restBox = new THREE.Box3();
  readonly flat: boolean;
  readonly extent: number;
  look = defaultLook();
  frame: Frame | null = null;
  private readonly bodies = new THREE.Scene();
  private readonly extras = new THREE.Scene(); // drawn over the bodies' depth, without shade of their own
  private readonly ground: Ground | null;
  private surfaces: Surface[] = [];
  private changed = true;
  private shadeIsOld = true;
  private groundHeight: number | null = null;
  private readonly section: Section;
  private sectionIsOld = true;
  private shownMap: ColorMap = "viridis";
  readonly labels = new Labels();
  readonly sceneMarks: SceneMarks;
  readonly connectors: Connectors;
  private readonly heldMarks: HeldMarks;
  private readonly faceLoads: FaceLoads;
  /** Bounding box of a whole run, for the camera: null where only the shown frame is known. */
  reach: THREE.Box3 | null = null;
  private bodyLooks: ReadonlyMap<string, BodyLook> = new Map();
  private readonly vectors: Vectors;
  private covered: Covered = { left: 0, right: 0, top: 0, bottom: 0 };
  private finest = 2; // pixels for each of the window's, at most

  constructor(
    readonly canvas: HTMLCanvasElement,
    readonly header: Header,
    topology: Topology,
    normals: (part: number) => Normals,
    renderer: THREE.WebGLRenderer | null = null, // renderer of the scene before, which goes
  ) {
    this.flat = header.dimension === 2;
    this.restBox.setFromArray(topology.restPositions);
    this.extent = header.extent || this.restBox.getSize(new THREE.Vector3()).length();
    this.renderer = renderer ?? rendererOf(canvas);
    this.orbit = new Orbit(this.flat, header.up);
    this.orbit.camera.layers.enable(LINES);
    this.marks = new Marks(this.extent, this.flat);
    this.extras.add(this.marks.group);
    this.ground = this.flat ? null : new Ground(this.uniforms, header.up);
    if (this.ground) this.extras.add(this.ground.disk);
    this.uniforms.lit.value = !this.flat;
    this.uniforms.hatch.value = 0.03 * this.extent;
    this.section = new Section(joined(topology.tetrahedra), this.uniforms);
    this.sceneMarks = new SceneMarks(
      header.marks ?? [],
      topology.restPositions,
      this.extent,
      this.uniforms,
      this.labels,
      header.parts,
    );
    this.connectors = new Connectors(header.connectors ?? [], this.extent);
    this.extras.add(this.connectors.group);
    this.heldMarks = new HeldMarks(this.extent, this.uniforms);
    this.faceLoads = new FaceLoads(topology.restPositions, this.extent);
    this.extras.add(this.sceneMarks.group, this.heldMarks.group, this.faceLoads.group);
    this.vectors = new Vectors(topology.restPositions, this.extent, header.fields);
    this.extras.add(this.vectors.mesh);
    this.buildSurfaces(topology, normals);
    this.colliders = new Colliders(header.colliders ?? [], topology.colliders, this.uniforms, this.flat);
    this.bodies.add(this.colliders.solids);
    this.extras.add(this.colliders.panes);
    this.orbit.fit(this.restBox);
    if (header.eye) this.orbit.lookFrom(header.eye);
    this.applyLook();
  }

  private buildSurfaces(topology: Topology, normals: (part: number) => Normals): void {
    const { bodyNames } = this;
    this.header.parts.forEach((part, i) => {
      const color = new THREE.Color(BODY_COLORS[bodyNames.indexOf(part.body) % BODY_COLORS.length]);
      const lines = new THREE.Color(part.kind === "cells" && this.hasSkin(part.body) ? 0x2b6cb0 : 0x1c1a1d);
      const surface = new Surface(
        part,
        topology.triangles[i],
        topology.edges[i],
        topology.restPositions,
        this.uniforms,
        color,
        part.kind === "skin" && hasSharpEdges(topology.triangles[i], topology.restPositions) ? "creased" : normals(i),
        lines,
      );
      this.surfaces.push(surface);
      this.bodies.add(surface.mesh);
    });
  }

  private hasSkin(body: string): boolean {
    return this.header.parts.some((part) => part.kind === "skin" && part.body === body);
  }

  get bodyNames(): string[] {
    return [...new Set(this.header.parts.map((part) => part.body))];
  }

  /** Sets visibility and transparency of the bodies. */
  setBodies(looks: ReadonlyMap<string, BodyLook>): void {
    this.bodyLooks = looks;
    this.applyLook();
    this.shadeIsOld = true;
  }

  private lookOf(body: string): BodyLook {
    return this.bodyLooks.get(body) ?? { visible: true, opacity: 1 };
  }

  /** Whether this part is the surface of its body; cells under a skin are only lines. */
  isSurface(part: number): boolean {
    const { kind, body } = this.header.parts[part];
    return kind === "skin" || !this.hasSkin(body);
  }

  /** Whether the surface of this part is drawn. */
  isShown(part: number): boolean {
    return this.isSurface(part) && this.lookOf(this.header.parts[part].body).visible;
  }

  /** Edges that are drawn as such, for tests. */
  get numCreases(): number {
    return this.surfaces.reduce((sum, surface) => sum + surface.numCreases, 0);
  }

  setFrame(frame: Frame): void {
    this.frame = frame;
    this.surfaces.forEach((surface, i) => {
      if (this.isShown(i) || this.look.cells) surface.update(frame);
    });
    this.vectors.update(
      frame,
      this.header.parts.filter((_, i) => this.isShown(i)),
    );
    if (frame.colliders) this.colliders.move(frame.colliders);
    this.sceneMarks.update(frame);
    this.connectors.update(frame.positions);
    this.heldMarks.update(frame.positions);
    this.faceLoads.update(frame.positions);
    this.sectionIsOld = true;
    if (frame.fieldValues) this.uniforms.fieldRange.value.set(frame.least, frame.greatest);
    this.changed = this.shadeIsOld = true;
  }

  /** The vertices at which faces are held. */
  setHeld(vertices: number[]): void {
    if (!this.heldMarks.set(vertices)) return;
    if (this.frame) this.heldMarks.update(this.frame.positions);
    this.changed = true;
  }

  /** Loads that were put on faces. */
  setLoads(loads: { vertices: number[]; directions: Vector[] }[]): void {
    if (!this.faceLoads.set(loads)) return;
    if (this.frame) this.faceLoads.update(this.frame.positions);
    this.changed = true;
  }

  /** Arrows of a field that are drawn, and what the longest stands for. */
  get arrows(): { count: number; longest: number } {
    return { count: this.vectors.count, longest: this.vectors.longest };
  }

  get loadedFaces(): number {
    return this.faceLoads.count;
  }

  get heldDots(): number {
    return this.heldMarks.count;
  }

  setLook(look: Partial<Look>): void {
    Object.assign(this.look, look);
    this.applyLook();
  }

  private applyLook(): void {
    const { look } = this;
    this.surfaces.forEach((surface, i) => {
      const shown = this.isShown(i);
      const body = this.lookOf(surface.part.body);
      const carried = surface.part.kind === "cells" && this.hasSkin(surface.part.body);
      surface.mesh.visible = shown;
      const overCells = shown && look.cells && surface.part.kind === "skin";
      surface.setOpacity(Math.min(body.opacity, overCells ? 0.42 : 1), true);
      surface.showCreases(shown && look.edges && !this.flat && surface.part.num_triangles <= MOST_TRIANGLES_WITH_EDGES);
      if (carried) surface.showLines(look.cells && body.visible, true, 0.85);
      else surface.showLines(shown && (look.wireframe || this.flat), false, look.wireframe ? 0.55 : 0.22);
    });
    this.sceneMarks.setVisible(look.marks);
    this.connectors.group.visible = look.marks;
    this.vectors.choose(look.arrows);
    this.orbit.setParallel(look.parallel);
    if (look.colorMap !== this.shownMap) {
      this.shownMap = look.colorMap;
      this.uniforms.colorMap.value.dispose();
      this.uniforms.colorMap.value = colorTexture(look.colorMap);
    }
    if (this.frame) this.setFrame(this.frame);
    this.colliders.setVisible(look.colliders);
    this.applyCut();
    this.applyGround();
    this.changed = true;
  }

  private applyCut(): void {
    const { look } = this;
    const axis = "xyz".indexOf(look.cutAxis);
    const normal = [0, 0, 0];
    const box = this.reach ?? this.restBox;
    const low = box.min.getComponent(axis);
    const high = box.max.getComponent(axis);
    const at = low + look.cutAt * (high - low);
    normal[axis] = look.cutFlip ? -1 : 1;
    this.uniforms.cut.value.set(normal[0], normal[1], normal[2], look.cutFlip ? -at : at);
    this.uniforms.cutOn.value = look.cut && !this.flat;
    this.sectionIsOld = true;
  }

  /** `height` along up [m]; null: there is none. */
  setGround(height: number | null): void {
    if (height === this.groundHeight) return;
    this.groundHeight = height;
    this.marks.setGroundLine(this.flat && height !== null ? height : null, this.header.up);
    this.applyGround();
  }

  private applyGround(): void {
    if (!this.ground) return;
    const visible = this.look.ground && this.groundHeight !== null;
    this.ground.disk.visible = visible;
    if (visible) this.ground.place(this.restBox.getCenter(new THREE.Vector3()), this.groundHeight!, this.extent);
    this.changed = this.shadeIsOld = true;
  }

  setBar(least: number, greatest: number): void {
    this.uniforms.barRange.value.set(least, greatest);
    this.changed = true;
  }

  setDark(dark: boolean): void {
    this.uniforms.dark.value = dark;
    this.vectors.setDark(dark);
    this.connectors.setDark(dark);
    this.changed = true;
  }

  /** The camera where the whole scene is seen, with the ground below it. */
  seeAll(): void {
    const now = this.frame ? this.boxOf(this.frame.positions) : new THREE.Box3();
    const box = (this.reach ?? (now.isEmpty() ? this.restBox : now)).clone().union(now);
    if (this.look.colliders) this.colliders.widen(box, 2 * this.extent);
    this.sceneMarks.widen(box);
    this.connectors.widen(box);
    this.faceLoads.widen(box);
    if (this.groundHeight !== null) {
      const up = new THREE.Vector3(...this.header.up);
      const low = box.getCenter(new THREE.Vector3());
      const above = low.dot(up) - this.groundHeight;
      if (above > 0 && above < 3 * this.extent) box.expandByPoint(low.addScaledVector(up, -above));
    }
    const { azimuth, elevation } = this.orbit.pose;
    this.orbit.fit(box, azimuth, elevation);
    this.changed = true;
  }

  /** Bounding box of the drawn objects; non-finite values are ignored. */
  boxOf(positions: Float32Array): THREE.Box3 {
    const box = new THREE.Box3();
    const place = new THREE.Vector3();
    this.header.parts.forEach(({ first_vertex: first, num_vertices: count }, part) => {
      if (!this.isShown(part)) return;
      for (let v = first; v < first + count; ++v) {
        place.fromArray(positions, 3 * v);
        if (Number.isFinite(place.x + place.y + place.z)) box.expandByPoint(place);
      }
    });
    return box;
  }

  /** About the width and the height of all bodies, from whatever side they are seen [m]. */
  get sizeSeen(): { width: number; height: number } {
    const size = (this.reach ?? this.restBox).getSize(new THREE.Vector3());
    const least = 1e-3 * this.extent;
    if (this.flat) return { width: Math.max(size.x, least), height: Math.max(size.y, least) };
    const up = new THREE.Vector3(...this.header.up).normalize();
    const upwards = Math.abs(up.x) * size.x + Math.abs(up.y) * size.y + Math.abs(up.z) * size.z;
    const around = Math.sqrt(Math.max(size.lengthSq() - upwards ** 2, 0));
    return { width: Math.max(around, least), height: Math.max(upwards + 0.4 * around, least) };
  }

  touch(): void {
    this.changed = true;
  }

  pickAt(x: number, y: number): Hit | null {
    if (!this.frame) return null;
    const shown = this.surfaces.flatMap((surface, part) =>
      this.isShown(part) ? [{ part, triangles: surface.triangles }] : [],
    );
    const { x: a, y: b, z: c, w } = this.uniforms.cut.value;
    const cutAway = this.uniforms.cutOn.value
      ? (px: number, py: number, pz: number) => a * px + b * py + c * pz > w
      : null;
    return pick(this.orbit.ray(x, y), shown, this.frame.positions, cutAway);
  }

  /** The cut through the cells as it is drawn, for tests. */
  get sectionTriangles() {
    return this.section.triangles;
  }

  /** The value of the shown field where a line of sight has met the surface; null: there is none. */
  valueAt({ corners, weights }: Hit): number | null {
    const { frame } = this;
    if (!frame?.fieldValues || corners.some((vertex) => frame.fieldValues![vertex] === 0)) return null;
    const share = corners.reduce((sum, vertex, i) => sum + weights[i] * (frame.fieldValues![vertex] - 1), 0) / 65534;
    return frame.least + share * (frame.greatest - frame.least);
  }

  triangleCount(): number {
    return this.surfaces.reduce((sum, s, i) => sum + (this.isShown(i) ? s.triangles.length / 3 : 0), 0);
  }

  /** `covered`: what panels take of the window, at its sides [pixels]. */
  resize(covered: Covered = this.covered): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.covered = covered;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, this.finest));
    this.renderer.setSize(width, height, false);
    this.orbit.resize(width, height, covered);
    this.changed = true;
  }

  /** Fewer pixels where drawing is slow. */
  setFinest(pixels: number): void {
    if (pixels === this.finest) return;
    this.finest = pixels;
    this.resize();
  }

  /** Draws when something has changed; true when it drew. */
  draw(): boolean {
    if (!this.changed) return false;
    this.changed = false;
    const { camera } = this.orbit;
    this.uniforms.pixels.value = this.renderer.getPixelRatio();
    this.marks.follow(this.orbit);
    this.connectors.follow(this.orbit);
    this.labels.follow(this.orbit);
    if (this.sectionIsOld)
      this.section.update(this.look.cut && !this.flat ? this.frame : null, this.uniforms.cut.value);
    this.sectionIsOld = false;
    this.section.render(this.renderer, camera);
    this.uniforms.up.value.set(...this.header.up).transformDirection(camera.matrixWorldInverse);
    if (this.ground?.disk.visible && this.shadeIsOld) this.ground.shade(this.renderer, this.bodies);
    this.shadeIsOld = false;
    this.renderer.clear();
    this.renderer.render(this.bodies, camera);
    this.renderer.render(this.extras, camera);
    return true;
  }

  dispose(): void {
    this.surfaces.forEach((surface) => surface.dispose());
    this.colliders.dispose();
    this.sceneMarks.dispose();
    this.connectors.dispose();
    this.heldMarks.dispose();
    this.faceLoads.dispose();
    this.section.dispose();
    this.vectors.dispose();
    this.labels.clear();
  }
}

function rendererOf(canvas: HTMLCanvasElement): THREE.WebGLRenderer {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setClearColor(0x000000, 0);
  renderer.autoClear = false;
  return renderer;
}
