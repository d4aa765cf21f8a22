/** Marks of boundary conditions, loads and probes at the vertices that the header names. */

import * as THREE from "three";
import type { SceneUniforms } from "./body_shader";
import type { Labels } from "./labels";
import type { Orbit } from "./orbit";
import type { Frame, Mark } from "./protocol";

const SUPPORT = 0x2a7f9e;
const LOAD = 0xc2410c;
const PROBE = 0x8250df;
const SUPPORT_SIZE = 6; // [pixels]
const ARROW = 0.13; // length of the arrow of the greatest force, relative to the extent
const LIFT = 0.02; // offset towards the eye, relative to the extent, so that a mark at a surface is seen

/** Points of one size in the window, a little before the surface that they lie on. */
function points(count: number, color: number, size: number, lift: number, shared: SceneUniforms): THREE.Points {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * count), 3));
  const material = new THREE.ShaderMaterial({
    vertexShader: /* glsl */ `
      uniform float size, lift;
      varying vec3 place;
      void main() {
        place = position;
        vec4 seen = viewMatrix * vec4(position, 1.0);
        seen.z += lift;
        gl_Position = projectionMatrix * seen;
        gl_PointSize = size;
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
    this.dots = points(vertices.length, SUPPORT, SUPPORT_SIZE * devicePixelRatio, LIFT * this.extent, this.shared);
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
function arrowGeometry(): THREE.BufferGeometry {
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

  update(vertices: number[], positions: Float32Array): void {
    const matrix = new THREE.Matrix4();
    const place = new THREE.Vector3();
    vertices.forEach((vertex, i) => {
      const length = this.lengths[i];
      place.fromArray(positions, 3 * vertex);
      const along = new THREE.Vector3(0, length, 0).applyQuaternion(this.turns[i]);
      if (this.pressing[i]) place.sub(along);
      this.mesh.setMatrixAt(i, matrix.compose(place, this.turns[i], new THREE.Vector3(length, length, length)));
    });
    this.mesh.instanceMatrix.needsUpdate = true;
  }
}

export class SceneMarks {
  readonly group = new THREE.Group();
  private readonly shown: { mark: Mark; points: THREE.Points | null; arrows: Arrows | null }[];

  constructor(
    marks: Mark[],
    rest: Float32Array,
    extent: number,
    shared: SceneUniforms,
    private readonly labels: Labels,
  ) {
    const box = new THREE.Box3().setFromArray(rest);
    const middle = box.getCenter(new THREE.Vector3());
    this.shown = marks.map((mark) => {
      const color = mark.kind === "support" ? SUPPORT : PROBE;
      const size = mark.kind === "support" ? SUPPORT_SIZE : 10;
      const arrows = mark.directions ? new Arrows(mark, rest, middle, extent) : null;
      const lift = (mark.kind === "probe" ? 4 : 1) * LIFT * extent; // it may stand under a skin
      const dots = arrows ? null : points(mark.vertices.length, color, size * devicePixelRatio, lift, shared);
      this.group.add(arrows?.mesh ?? dots!);
      return { mark, points: dots, arrows };
    });
  }

  update({ positions }: Pick<Frame, "positions">): void {
    if (!this.group.visible) return;
    for (const { mark, points: dots, arrows } of this.shown) {
      arrows?.update(mark.vertices, positions);
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
