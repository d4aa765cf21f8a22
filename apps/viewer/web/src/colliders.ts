/** Colliders as they are at the time of a frame: solid where they have an inside, else like glass; in 2D lines. */

import * as THREE from "three";
import type { SceneUniforms } from "./body_shader";
import type { Collider, ColliderShape, Part } from "./protocol";
import { Surface } from "./surface";

const COLOR = 0x98a2ae;
const GLASS = 0.3; // opacity
const LINE = 0.9; // opacity in 2D
const ENDLESS = 40; // times as long as it comes is what has no end in 2D
const POINT = 5; // [pixels]

/** Numbers that say where a collider is: the rows of (A b) in x = A X + b. */
export const NUMBERS = 12;

/** Facets of a collider, by how many different corners they have. */
interface Facets {
  triangles: number[];
  lines: number[];
  points: number[];
}

function facetsOf({ facets }: ColliderShape, dimension: number): Facets {
  const sorted: Facets = { triangles: [], lines: [], points: [] };
  for (let f = 0; f < facets.length; f += dimension) {
    const corners = [...new Set(facets.subarray(f, f + dimension))];
    const kind = corners.length === 3 ? "triangles" : corners.length === 2 ? "lines" : "points";
    sorted[kind].push(...corners);
  }
  return sorted;
}

/** The one loop that lines make; empty when they make none, or several. */
function loopOf(lines: number[]): number[] {
  const next = new Map<number, number>();
  for (let i = 0; i < lines.length; i += 2) next.set(lines[i], lines[i + 1]);
  const loop: number[] = [];
  for (let at = lines[0]; at !== undefined && loop.length < next.size; at = next.get(at)!) loop.push(at);
  return loop.length === lines.length / 2 && next.get(loop[loop.length - 1]) === lines[0] ? loop : [];
}

/** Fills a closed line with triangles. */
function filled(loop: number[], vertices: Float32Array): number[] {
  const contour = loop.map((v) => new THREE.Vector2(vertices[3 * v], vertices[3 * v + 1]));
  return THREE.ShapeUtils.triangulateShape(contour, []).flatMap((corners) => corners.map((i) => loop[i]));
}

class ShownCollider {
  readonly places: Float32Array;
  private readonly vertices: Float32Array;
  private readonly surfaces: Surface[] = [];
  private readonly points: THREE.BufferAttribute | null = null;

  constructor(
    readonly collider: Collider,
    shape: ColliderShape,
    shared: SceneUniforms,
    flat: boolean,
    solids: THREE.Group,
    panes: THREE.Group,
  ) {
    this.vertices = flat && collider.endless ? lengthened(shape.vertices) : shape.vertices;
    this.places = this.vertices.slice();
    const facets = facetsOf(shape, flat ? 2 : 3);
    if (flat && collider.closed) facets.triangles = filled(loopOf(facets.lines), this.vertices);
    const group = collider.closed ? solids : panes;
    const add = (triangles: number[], lines: number[]) => {
      const part = partOf(this.vertices.length / 3, triangles.length / 3, lines.length / 2);
      const color = new THREE.Color(COLOR);
      const normals = triangles.length > 0 ? "creased" : "given";
      const [corners, ends] = [Uint32Array.from(triangles), Uint32Array.from(lines)];
      const surface = new Surface(part, corners, ends, this.vertices, shared, color, normals, color);
      group.add(surface.mesh);
      this.surfaces.push(surface);
      return surface;
    };
    if (facets.triangles.length > 0) {
      const surface = add(facets.triangles, []);
      if (!collider.closed || flat) surface.setOpacity(GLASS);
      surface.mesh.material.depthWrite = collider.closed && !flat;
    }
    if (facets.lines.length > 0) add([], facets.lines).showLines(true, false, LINE);
    if (facets.points.length > 0) {
      this.points = new THREE.BufferAttribute(this.places, 3);
      const geometry = new THREE.BufferGeometry().setAttribute("position", this.points);
      geometry.setIndex(facets.points);
      const made = new THREE.Points(
        geometry,
        new THREE.PointsMaterial({ color: COLOR, size: POINT, sizeAttenuation: false }),
      );
      made.frustumCulled = false;
      panes.add(made);
    }
  }

  /** `at`: where its numbers begin. */
  move(numbers: Float32Array, at: number): void {
    const { vertices, places } = this;
    for (let i = 0; i < vertices.length; i += 3)
      for (let k = 0; k < 3; ++k) {
        const row = at + 4 * k;
        places[i + k] =
          numbers[row] * vertices[i] +
          numbers[row + 1] * vertices[i + 1] +
          numbers[row + 2] * vertices[i + 2] +
          numbers[row + 3];
      }
    for (const surface of this.surfaces) surface.update({ positions: places, normals: null, fieldValues: null });
    if (this.points) this.points.needsUpdate = true;
  }

  dispose(): void {
    this.surfaces.forEach((surface) => surface.dispose());
  }
}

function partOf(num_vertices: number, num_triangles: number, num_edges: number): Part {
  const counts = { first_vertex: 0, num_vertices, num_triangles, num_edges };
  return { name: "", body: "", kind: "cells", ...counts };
}

/** A line of two ends, many times as long. */
function lengthened(ends: Float32Array): Float32Array {
  return ends.map((value, i) => value + ENDLESS * (value - ends[(i + 3) % 6]));
}

export class Colliders {
  readonly solids = new THREE.Group(); // to be drawn with the bodies, whose shade they share
  readonly panes = new THREE.Group(); // to be drawn after them
  private readonly shown: ShownCollider[];
  private numbers = new Float32Array(0);

  constructor(colliders: Collider[], shapes: ColliderShape[], shared: SceneUniforms, flat: boolean) {
    this.shown = colliders.map(
      (collider, i) => new ShownCollider(collider, shapes[i], shared, flat, this.solids, this.panes),
    );
  }

  /** `numbers`: those of all colliders of a frame. */
  move(numbers: Float32Array): void {
    const same = numbers.length === this.numbers.length && numbers.every((value, i) => value === this.numbers[i]);
    if (same || numbers.length !== NUMBERS * this.shown.length) return;
    this.numbers = numbers.slice();
    this.shown.forEach((collider, i) => collider.move(numbers, NUMBERS * i));
  }

  setVisible(visible: boolean): void {
    this.solids.visible = this.panes.visible = visible;
  }

  /** Makes the box hold what of them is within `reach` [m] of it, but for those without end. */
  widen(box: THREE.Box3, reach: number): void {
    const near = box.clone().expandByScalar(reach);
    for (const { collider, places } of this.shown) {
      if (collider.endless) continue;
      const own = new THREE.Box3().setFromArray(places).intersect(near);
      if (!own.isEmpty()) box.union(own);
    }
  }

  /** Where the first vertex of each is, for tests. */
  get firstPlaces(): number[][] {
    return this.shown.map(({ places }) => Array.from(places.subarray(0, 3)));
  }

  dispose(): void {
    this.shown.forEach((collider) => collider.dispose());
  }
}
