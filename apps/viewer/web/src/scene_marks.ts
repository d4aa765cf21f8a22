/** Marks of boundary conditions, loads and probes at the vertices that the header names. */

import * as THREE from "three";
import type { SceneUniforms } from "./body_shader";
import type { Labels } from "./labels";
import type { Orbit } from "./orbit";
import type { Frame, Mark, Part, Vector } from "./protocol";

const SUPPORT = 0x2a7f9e;
const LOAD = 0xc2410c;
const PROBE = 0x8250df;
const SUPPORT_SIZE = 6; // [pixels]
const ARROW = 0.13; // length of the arrow of the greatest force, relative to the extent
const LIFT = 0.02; // offset towards the eye in depth, relative to the extent, so that marks at a surface are seen

/** Points of one size in the window, a little before the surface that they lie on. */
function points(count: number, color: number, size: number, lift: number, shared: SceneUniforms): THREE.Points {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * count), 3));
  const material = new THREE.ShaderMaterial({
    vertexShader: /* glsl */ `
      uniform float size, lift, pixels;
      varying vec3 place;
      void main() {
        place = position;
        vec4 seen = viewMatrix * vec4(position, 1.0);
        vec4 lifted = projectionMatrix * (seen + vec4(0.0, 0.0, lift, 0.0));
        gl_Position = projectionMatrix * seen;
        gl_Position.z = lifted.z / lifted.w * gl_Position.w;
        gl_PointSize = size * pixels;
      }`,
    fragmentShader: /* glsl */ `
      uniform vec3 color;
      uniform vec4 cut;
      uniform bool cutOn;
      varying vec3 place;
      void main() {
        if (cutOn && dot(cut.xyz, place) > cut.w) discard;
        float r = length(gl_PointCoord - 0.5) * 2.0;
        if (r > 1.0) discard;
        gl_FragColor = vec4(r > 0.68 ? vec3(1.0) : color, 1.0);
        #include <colorspace_fragment>
      }`,
    uniforms: { ...shared, color: { value: new THREE.Color(color) }, size: { value: size }, lift: { value: lift } },
  });
  const made = new THREE.Points(geometry, material);
  made.frustumCulled = false;
  made.renderOrder = 3;
  return made;
}

/** Marks of parts that the user holds, drawn as the boundary conditions of the scene are. */
export class HeldMarks {
  readonly group = new THREE.Group();
  private vertices: number[] = [];
  private dots: THREE.Points | null = null;

  constructor(
    private readonly extent: number,
    private readonly shared: SceneUniforms,
  ) {}

  /** True when they are others than before. */
  set(vertices: number[]): boolean {
    if (vertices.length === this.vertices.length && vertices.every((vertex, i) => vertex === this.vertices[i]))
      return false;
    this.dispose();
    this.vertices = vertices;
    if (vertices.length === 0) return true;
    this.dots = points(vertices.length, SUPPORT, SUPPORT_SIZE, LIFT * this.extent, this.shared);
    this.group.add(this.dots);
    return true;
  }

  update(positions: Float32Array): void {
    if (this.dots) moveTo(this.dots, this.vertices, positions);
  }

  /** How many dots are drawn, for tests. */
  get count(): number {
    return this.dots ? this.vertices.length : 0;
  }

  dispose(): void {
    if (!this.dots) return;
    this.group.remove(this.dots);
    this.dots.geometry.dispose();
    (this.dots.material as THREE.Material).dispose();
    this.dots = null;
  }
}

function moveTo(dots: THREE.Points, vertices: number[], positions: Float32Array): void {
  const attribute = dots.geometry.getAttribute("position") as THREE.BufferAttribute;
  vertices.forEach((vertex, i) =>
    attribute.setXYZ(i, positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]),
  );
  attribute.needsUpdate = true;
}

/** An arrow of length 1 along y. */
export function arrowGeometry(): THREE.BufferGeometry {
  const profile = [
    [0, 0],
    [0.028, 0],
    [0.028, 0.68],
    [0.09, 0.68],
    [0, 1],
  ];
  return new THREE.LatheGeometry(
    profile.map(([r, h]) => new THREE.Vector2(r, h)),
    10,
  );
}

class Arrows {
  readonly mesh: THREE.InstancedMesh;
  private readonly turns: THREE.Quaternion[];
  private readonly lengths: number[];
  private readonly pressing: boolean[]; // towards the body: the tip is at the vertex
  readonly box = new THREE.Box3(); // box of the arrows as they are drawn

  constructor(mark: Mark, rest: Float32Array, middle: THREE.Vector3, extent: number) {
    const directions = mark.directions!.map((d) => new THREE.Vector3(...d));
    this.turns = directions.map((d) =>
      new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), d.clone().normalize()),
    );
    this.lengths = directions.map((d) => ARROW * extent * Math.max(d.length(), 0.3));
    this.pressing = directions.map(
      (d, i) =>
        new THREE.Vector3()
          .fromArray(rest, 3 * mark.vertices[i])
          .sub(middle)
          .dot(d) < 0,
    );
    const material = new THREE.MeshBasicMaterial({ color: LOAD });
    this.mesh = new THREE.InstancedMesh(arrowGeometry(), material, mark.vertices.length);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 3;
  }

  /** `factor`: of the strongest force, less than 0 the other way. */
  update(vertices: number[], positions: Float32Array, factor: number): void {
    this.mesh.visible = Math.abs(factor) > 1e-6;
    const back = new THREE.Quaternion();
    if (factor < 0) back.setFromAxisAngle(new THREE.Vector3(1, 0, 0), Math.PI);
    const matrix = new THREE.Matrix4();
    const place = new THREE.Vector3();
    this.box.makeEmpty();
    vertices.forEach((vertex, i) => {
      const length = this.lengths[i] * Math.max(Math.min(Math.abs(factor), 1), 0.12);
      const turn = this.turns[i].clone().multiply(back);
      place.fromArray(positions, 3 * vertex);
      const along = new THREE.Vector3(0, length, 0).applyQuaternion(turn);
      if (this.pressing[i] === factor > 0) place.sub(along);
      if (this.mesh.visible) this.box.expandByPoint(place).expandByPoint(along.add(place));
      this.mesh.setMatrixAt(i, matrix.compose(place, turn, new THREE.Vector3(length, length, length)));
    });
    this.mesh.instanceMatrix.needsUpdate = true;
  }
}

/** How strong a load is at this time or load factor, over its strongest. */
function factorAt({ course }: Mark, time: number, load: number | undefined): number {
  if (!course || course.at.length === 0) return 1;
  const { at, factors } = course;
  const place = course.over === "load" ? (load ?? 1) : time;
  const after = at.findIndex((t) => t >= place);
  if (after < 0) return factors[factors.length - 1];
  if (after === 0) return factors[0];
  const share = (place - at[after - 1]) / (at[after] - at[after - 1]);
  return factors[after - 1] + share * (factors[after] - factors[after - 1]);
}

const NEAR = 0.12; // largest distance of a mark on the skin from its node, relative to the extent

/** Marks of cells under a skin stand on the skin: what is in the air or inside would belong to nothing that is seen. */
function onSkins(mark: Mark, parts: Part[], rest: Float32Array, extent: number): Mark {
  const vertices: number[] = [];
  const directions: Vector[] = [];
  const taken = new Set<number>();
  mark.vertices.forEach((vertex, i) => {
    const part = parts.find(({ first_vertex: first, num_vertices: n }) => vertex >= first && vertex < first + n);
    const skin =
      part?.kind === "cells" ? parts.find((other) => other.kind === "skin" && other.body === part.body) : null;
    let at = vertex;
    if (skin && mark.kind !== "probe") {
      let least = (NEAR * extent) ** 2;
      at = -1;
      const [x, y, z] = rest.subarray(3 * vertex, 3 * vertex + 3);
      for (let v = skin.first_vertex; v < skin.first_vertex + skin.num_vertices; ++v) {
        const away = (rest[3 * v] - x) ** 2 + (rest[3 * v + 1] - y) ** 2 + (rest[3 * v + 2] - z) ** 2;
        if (away < least) [least, at] = [away, v];
      }
      if (at < 0 || taken.has(at)) return;
      taken.add(at);
    }
    vertices.push(at);
    if (mark.directions) directions.push(mark.directions[i]);
  });
  if (vertices.length === 0) return mark;
  return { ...mark, vertices, directions: mark.directions && directions };
}

/** Loads that were put on faces of the live scene, drawn as the loads of the scene are. */
export class FaceLoads {
  readonly group = new THREE.Group();
  private shown: { vertices: number[]; arrows: Arrows }[] = [];
  private key = "";

  constructor(
    private readonly rest: Float32Array,
    private readonly extent: number,
  ) {}

  /** True when they are others than before. */
  set(loads: { vertices: number[]; directions: Vector[] }[]): boolean {
    const key = JSON.stringify(loads);
    if (key === this.key) return false;
    this.dispose();
    this.key = key;
    const middle = new THREE.Box3().setFromArray(this.rest).getCenter(new THREE.Vector3());
    this.shown = loads.map(({ vertices, directions }) => ({
      vertices,
      arrows: new Arrows({ kind: "load", name: "", vertices, directions }, this.rest, middle, this.extent),
    }));
    for (const { arrows } of this.shown) this.group.add(arrows.mesh);
    return true;
  }

  update(positions: Float32Array): void {
    for (const { vertices, arrows } of this.shown) arrows.update(vertices, positions, 1);
  }

  /** Makes the box hold the arrows. */
  widen(box: THREE.Box3): void {
    for (const { arrows } of this.shown) box.union(arrows.box);
  }

  /** How many faces have one, for tests. */
  get count(): number {
    return this.shown.length;
  }

  dispose(): void {
    for (const { arrows } of this.shown) {
      this.group.remove(arrows.mesh);
      arrows.mesh.geometry.dispose();
      (arrows.mesh.material as THREE.Material).dispose();
    }
    this.shown = [];
    this.key = "";
  }
}

export class SceneMarks {
  readonly group = new THREE.Group();
  factors: number[] = []; // factors of the loads, as they are drawn
  private readonly shown: { mark: Mark; points: THREE.Points | null; arrows: Arrows | null }[];

  constructor(
    marks: Mark[],
    rest: Float32Array,
    extent: number,
    shared: SceneUniforms,
    private readonly labels: Labels,
    parts: Part[],
  ) {
    const box = new THREE.Box3().setFromArray(rest);
    const middle = box.getCenter(new THREE.Vector3());
    this.shown = marks.map((given) => {
      const mark = onSkins(given, parts, rest, extent);
      const color = mark.kind === "support" ? SUPPORT : PROBE;
      const size = mark.kind === "support" ? SUPPORT_SIZE : 10;
      const arrows = mark.directions ? new Arrows(mark, rest, middle, extent) : null;
      const lift = (mark.kind === "probe" ? 4 : 1) * LIFT * extent; // it may stand under a skin
      const dots = arrows ? null : points(mark.vertices.length, color, size, lift, shared);
      this.group.add(arrows?.mesh ?? dots!);
      return { mark, points: dots, arrows };
    });
  }

  /** `load`: the load factor of the frame; none: that of the course's time alone. */
  update({ positions, time, load }: Pick<Frame, "positions" | "time" | "load">): void {
    if (!this.group.visible) return;
    this.factors = [];
    for (const { mark, points: dots, arrows } of this.shown) {
      if (arrows) {
        const factor = factorAt(mark, time, load);
        this.factors.push(factor);
        arrows.update(mark.vertices, positions, factor);
      }
      if (dots) moveTo(dots, mark.vertices, positions);
      if (mark.kind === "probe") {
        const place = new THREE.Vector3().fromArray(positions, 3 * mark.vertices[0]);
        this.labels.set(`probe-${mark.name}`, mark.name, place, "probe");
      }
    }
  }

  setVisible(visible: boolean): void {
    this.group.visible = visible;
    if (visible) return;
    for (const { mark } of this.shown)
      if (mark.kind === "probe") this.labels.set(`probe-${mark.name}`, "", null, "probe");
  }

  /** Makes the box hold the arrows that are drawn. */
  widen(box: THREE.Box3): void {
    if (this.group.visible) for (const { arrows } of this.shown) if (arrows) box.union(arrows.box);
  }

  /** The ends of all arrows, for tests. */
  get arrowBox(): number[] {
    const box = new THREE.Box3();
    this.widen(box);
    return box.isEmpty() ? [] : [...box.min.toArray(), ...box.max.toArray()];
  }

  /** The vertices at which dots and arrows stand, for tests. */
  get dotVertices(): number[] {
    return this.shown.flatMap(({ mark }) => mark.vertices);
  }

  /** Where each mark's first place is seen, for tests. */
  seen(orbit: Orbit, positions: Float32Array): { kind: string; name: string; x: number; y: number }[] {
    return this.shown.map(({ mark }) => ({
      kind: mark.kind,
      name: mark.name,
      ...orbit.project(new THREE.Vector3().fromArray(positions, 3 * mark.vertices[0])),
    }));
  }

  dispose(): void {
    for (const { points: dots, arrows } of this.shown) {
      const made = dots ?? arrows!.mesh;
      made.geometry.dispose();
      (made.material as THREE.Material).dispose();
    }
  }
}
