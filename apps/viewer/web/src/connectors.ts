/** Joints, springs and cables: rods and dots that show through the bodies that hide them. */

import * as THREE from "three";
import type { Orbit } from "./orbit";
import type { Connector, Vector } from "./protocol";

const JOINT = { light: 0x7a4a00, dark: 0xf0b429 };
const CABLE = { light: 0x1f2933, dark: 0xe4e7eb };
const HIDDEN = 0.3; // opacity of what bodies hide
const COIL_TURNS = 6;
const COIL_WIDTH = 0.02; // relative to the extent

const isCord = ({ kind }: Connector) => kind === "cable" || kind === "spring";

/** A material and its double for what is hidden. */
function materials(): THREE.MeshBasicMaterial[] {
  const seen = new THREE.MeshBasicMaterial();
  const hidden = new THREE.MeshBasicMaterial({
    transparent: true,
    opacity: HIDDEN,
    depthTest: false,
    depthWrite: false,
  });
  return [seen, hidden];
}

/** One shape at many places. */
class Copies {
  readonly meshes: THREE.InstancedMesh[];

  constructor(geometry: THREE.BufferGeometry, shades: THREE.MeshBasicMaterial[], count: number) {
    this.meshes = shades.map((material, i) => {
      const mesh = new THREE.InstancedMesh(geometry, material, count);
      mesh.frustumCulled = false;
      mesh.renderOrder = i === 0 ? 3 : 2;
      return mesh;
    });
  }

  place(number: number, matrix: THREE.Matrix4): void {
    for (const mesh of this.meshes) mesh.setMatrixAt(number, matrix);
  }

  done(): void {
    for (const mesh of this.meshes) mesh.instanceMatrix.needsUpdate = true;
  }

  dispose(): void {
    this.meshes[0].geometry.dispose();
    for (const mesh of this.meshes) mesh.dispose();
  }
}

const UP = new THREE.Vector3(0, 1, 0);

export class Connectors {
  readonly group = new THREE.Group();
  private readonly joint = materials();
  private readonly cord = materials();
  private readonly rods: { joint: Copies; cord: Copies };
  private readonly dots: { joint: Copies; cord: Copies };
  private places: THREE.Vector3[][] = [];
  private pixel = 0; // [m]

  constructor(
    private readonly connectors: Connector[],
    private readonly extent: number,
  ) {
    const rod = () => new THREE.CylinderGeometry(1, 1, 1, 8);
    const ball = () => new THREE.SphereGeometry(1, 16, 10);
    const count = (cords: boolean, of: (each: Connector) => number) =>
      connectors.reduce((sum, each) => sum + (isCord(each) === cords ? of(each) : 0), 0);
    const numRods = (each: Connector) => (each.kind === "spring" ? 2 * COIL_TURNS + 2 : 1) * each.lines.length;
    this.rods = {
      joint: new Copies(rod(), this.joint, count(false, numRods)),
      cord: new Copies(rod(), this.cord, count(true, numRods)),
    };
    this.dots = {
      joint: new Copies(
        ball(),
        this.joint,
        count(false, ({ dots }) => dots.length),
      ),
      cord: new Copies(
        ball(),
        this.cord,
        count(true, ({ dots }) => dots.length),
      ),
    };
    for (const copies of this.copies) this.group.add(...copies.meshes);
    this.setDark(false);
  }

  private get copies(): Copies[] {
    return [this.rods.joint, this.rods.cord, this.dots.joint, this.dots.cord];
  }

  get count(): number {
    return this.connectors.length;
  }

  /** Where the points of each connector are [m], for tests. */
  get points(): Vector[][] {
    return this.places.map((points) => points.map((point) => point.toArray() as Vector));
  }

  setDark(dark: boolean): void {
    for (const material of this.joint) material.color.setHex(dark ? JOINT.dark : JOINT.light);
    for (const material of this.cord) material.color.setHex(dark ? CABLE.dark : CABLE.light);
  }

  update(positions: Float32Array): void {
    if (this.connectors.length === 0) return;
    this.places = this.connectors.map(({ points }) =>
      points.map(({ at, vertices = [], weights = [] }) => {
        const place = new THREE.Vector3(...(at ?? [0, 0, 0]));
        const corner = new THREE.Vector3();
        vertices.forEach((vertex, i) => place.addScaledVector(corner.fromArray(positions, 3 * vertex), weights[i]));
        return place;
      }),
    );
    this.arrange();
  }

  /** Rods and dots keep their width in the window. */
  follow(orbit: Orbit): void {
    const pixel = orbit.pixelSize();
    if (pixel === this.pixel || !this.group.visible) return;
    this.pixel = pixel;
    this.arrange();
  }

  /** Makes the box hold all points. */
  widen(box: THREE.Box3): void {
    if (this.group.visible) for (const points of this.places) for (const point of points) box.expandByPoint(point);
  }

  private arrange(): void {
    const next = { joint: { rods: 0, dots: 0 }, cord: { rods: 0, dots: 0 } };
    const matrix = new THREE.Matrix4();
    const turn = new THREE.Quaternion();
    const thickness = this.pixel || 0.003 * this.extent;
    this.connectors.forEach((connector, i) => {
      const points = this.places[i];
      if (!points) return;
      const kind = isCord(connector) ? "cord" : "joint";
      const rod = (from: THREE.Vector3, to: THREE.Vector3, width: number) => {
        const way = to.clone().sub(from);
        const length = way.length();
        if (length > 0) turn.setFromUnitVectors(UP, way.divideScalar(length));
        const middle = from.clone().add(to).multiplyScalar(0.5);
        matrix.compose(middle, turn, new THREE.Vector3(width * thickness, length, width * thickness));
        this.rods[kind].place(next[kind].rods++, matrix);
      };
      for (const [a, b] of connector.lines) {
        if (connector.kind !== "spring") rod(points[a], points[b], kind === "cord" ? 1.4 : 1.1);
        else {
          const coil = coilBetween(points[a], points[b], COIL_WIDTH * this.extent);
          for (let k = 1; k < coil.length; ++k) rod(coil[k - 1], coil[k], 0.9);
        }
      }
      const radius = (kind === "cord" ? 3 : 4.5) * thickness;
      for (const dot of connector.dots) {
        matrix.compose(points[dot], turn.identity(), new THREE.Vector3(radius, radius, radius));
        this.dots[kind].place(next[kind].dots++, matrix);
      }
    });
    for (const copies of this.copies) copies.done();
  }

  dispose(): void {
    for (const copies of this.copies) copies.dispose();
    for (const material of [...this.joint, ...this.cord]) material.dispose();
  }
}

/** Corners of a flat coil. */
function coilBetween(from: THREE.Vector3, to: THREE.Vector3, width: number): THREE.Vector3[] {
  const way = to.clone().sub(from);
  const side = new THREE.Vector3(-way.y, way.x, 0);
  if (side.lengthSq() < 1e-12 * way.lengthSq()) side.set(1, 0, 0);
  side.normalize().multiplyScalar(width);
  const corners = [from];
  const count = 2 * COIL_TURNS;
  for (let k = 0; k <= count; ++k) {
    const share = 0.15 + (0.7 * k) / count;
    const sign = k === 0 || k === count ? 0 : k % 2 ? 1 : -1;
    corners.push(from.clone().addScaledVector(way, share).addScaledVector(side, sign));
  }
  corners.push(to);
  return corners;
}
