/** A half section of an axisymmetric recording as a revolved body: a scene in 3D about the y axis. */

import { NUMBERS } from "./colliders";
import type { ColliderShape, Frame, Header, Part, Topology } from "./protocol";

/** Angles that the page offers [degrees]; 0: the half section itself. */
export const ANGLES = [0, 180, 270, 360];
const SECTOR = (5 * Math.PI) / 180; // about the angle of a facet [rad]
const AXIS = 1e-6; // times the extent: nearer to the axis than this is on it

/** Edges that one triangle alone has, in its sense: the body is at their left. */
export function rimOf(triangles: Uint32Array): [number, number][] {
  const open = new Map<string, [number, number]>();
  for (let i = 0; i < triangles.length; i += 3)
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [triangles[i + k], triangles[i + ((k + 1) % 3)]];
      if (!open.delete(`${b} ${a}`)) open.set(`${a} ${b}`, [a, b]);
    }
  return [...open.values()];
}

export class Revolved {
  readonly header: Header;
  readonly topology: Topology;
  /** The vertex of the section that each vertex is a copy of. */
  readonly source: Uint32Array;
  private readonly first: Uint32Array; // vertex of the first layer, by vertex of the section
  private readonly cosine: Float32Array; // by vertex
  private readonly sine: Float32Array;
  private readonly radii: number[]; // mean radius of each collider

  /** `colliders`: where they are in the first frame, 12 numbers each. */
  constructor(
    header: Header,
    section: Topology,
    angle: number,
    private readonly colliders: Float32Array,
  ) {
    const turn = (angle * Math.PI) / 180;
    const sectors = Math.max(3, Math.round(turn / SECTOR));
    const isClosed = angle >= 360;
    const source: number[] = [];
    const layer: number[] = [];
    this.first = new Uint32Array(section.restPositions.length / 3);
    const topology: Topology = {
      triangles: [],
      edges: [],
      tetrahedra: [],
      restPositions: new Float32Array(),
      colliders: [],
    };
    const parts = header.parts.map((part, p): Part => {
      const begin = source.length;
      const { first_vertex: from, num_vertices: count } = part;
      const add = (vertex: number, at: number) => {
        source.push(vertex);
        layer.push(at);
        return source.length - 1;
      };
      const triangles: number[] = [];
      // Both ends show the section.
      for (let v = from; v < from + count; ++v) this.first[v] = add(v, 0);
      const at: Map<number, number>[] = [new Map()];
      for (let v = from; v < from + count; ++v) at[0].set(v, this.first[v]);
      const rim = rimOf(section.triangles[p]);
      const ends = new Set(rim.flat());
      for (let k = 1; k < sectors; ++k) at.push(new Map([...ends].map((v) => [v, add(v, k)])));
      if (isClosed) at.push(at[0]);
      else {
        at.push(new Map());
        for (let v = from; v < from + count; ++v) at[sectors].set(v, add(v, sectors));
        const flat = section.triangles[p];
        for (const v of flat) triangles.push(at[0].get(v)!);
        for (let i = 0; i < flat.length; i += 3)
          for (const k of [0, 2, 1]) triangles.push(at[sectors].get(flat[i + k])!);
      }
      const isOnAxis = (v: number) => Math.abs(section.restPositions[3 * v]) <= AXIS * header.extent;
      for (const [a, b] of rim) {
        if (isOnAxis(a) && isOnAxis(b)) continue;
        for (let k = 0; k < sectors; ++k) {
          const [a0, b0, a1, b1] = [at[k].get(a)!, at[k].get(b)!, at[k + 1].get(a)!, at[k + 1].get(b)!];
          if (!isOnAxis(a)) triangles.push(a0, a1, b0);
          if (!isOnAxis(b)) triangles.push(b0, a1, b1);
        }
      }
      const edges = isClosed ? [] : [0, sectors].flatMap((k) => [...section.edges[p]].map((v) => at[k].get(v)!));
      topology.triangles.push(Uint32Array.from(triangles));
      topology.edges.push(Uint32Array.from(edges));
      topology.tetrahedra.push(new Uint32Array());
      return {
        ...part,
        first_vertex: begin,
        num_vertices: source.length - begin,
        num_triangles: triangles.length / 3,
        num_edges: edges.length / 2,
        num_tetrahedra: 0,
      };
    });
    this.source = Uint32Array.from(source);
    this.cosine = Float32Array.from(layer, (k) => Math.cos((k * turn) / sectors));
    this.sine = Float32Array.from(layer, (k) => Math.sin((k * turn) / sectors));
    topology.restPositions = this.turned(section.restPositions);
    topology.colliders = section.colliders.map((shape, i) =>
      revolvedCollider(placed(shape, colliders, NUMBERS * i), turn, sectors),
    );
    this.radii = topology.colliders.map(({ vertices }) => {
      let sum = 0;
      for (let i = 0; i < vertices.length; i += 3) sum += Math.hypot(vertices[i], vertices[i + 2]);
      return (3 * sum) / Math.max(1, vertices.length);
    });
    this.topology = topology;
    this.header = {
      ...header,
      dimension: 3,
      parts,
      colliders: header.colliders?.map((collider, i) => ({
        ...collider,
        closed: false,
        num_vertices: topology.colliders[i].vertices.length / 3,
        num_facets: topology.colliders[i].facets.length / 3,
      })),
      marks: header.marks?.map((mark) => ({ ...mark, vertices: mark.vertices.map((v) => this.first[v]) })),
      connectors: header.connectors?.map((connector) => ({
        ...connector,
        points: connector.points.map((point) => ({
          ...point,
          vertices: point.vertices?.map((v) => this.first[v]),
        })),
      })),
    };
  }

  /** The copy of a vertex of the section that is in its plane. */
  copyOf(vertex: number): number {
    return this.first[vertex];
  }

  /** A frame of the section as one of the body. */
  frame(frame: Frame): Frame {
    return {
      ...frame,
      positions: this.turned(frame.positions),
      fieldValues: frame.fieldValues && Uint16Array.from(this.source, (v) => frame.fieldValues![v]),
      colliders: frame.colliders && this.moved(frame.colliders),
      arrows: frame.arrows && { ...frame.arrows, vectors: this.turned(frame.arrows.vectors) },
    };
  }

  /**
   * Colliders as they have moved since the first frame: along the axis, and outward by scaling about it. The latter is
   * exact for cylinders and planes; others keep the shape of their section only about their mean radius.
   */
  private moved(numbers: Float32Array): Float32Array {
    const found = numbers.map((_, i) => ([0, 5, 10].includes(i % NUMBERS) ? 1 : 0));
    this.radii.forEach((radius, collider) => {
      const at = NUMBERS * collider;
      const [outward, up] = [at + 3, at + 7].map((i) => numbers[i] - this.colliders[i]);
      if (radius > 0) found[at] = found[at + 10] = 1 + outward / radius;
      found[at + 7] = up;
    });
    return found;
  }

  /** Three numbers per vertex, turned with the section. */
  private turned(values: Float32Array): Float32Array {
    const { source, cosine, sine } = this;
    const found = new Float32Array(3 * source.length);
    for (let v = 0; v < source.length; ++v) {
      const [x, y] = [values[3 * source[v]], values[3 * source[v] + 1]];
      found[3 * v] = cosine[v] * x;
      found[3 * v + 1] = y;
      found[3 * v + 2] = -sine[v] * x;
    }
    return found;
  }
}

/** A collider at its place in the plane. */
function placed({ vertices, facets }: ColliderShape, numbers: Float32Array, at: number): ColliderShape {
  const places = vertices.slice();
  for (let i = 0; i < places.length; i += 3)
    for (let k = 0; k < 2; ++k) {
      const row = at + 4 * k;
      places[i + k] = numbers[row] * vertices[i] + numbers[row + 1] * vertices[i + 1] + numbers[row + 3];
    }
  return { vertices: places, facets };
}

/** The lines of a collider as a surface of triangles, on the side of positive radii. */
function revolvedCollider({ vertices, facets }: ColliderShape, turn: number, sectors: number): ColliderShape {
  const places: number[] = [];
  const corners: number[] = [];
  for (let f = 0; f < facets.length; f += 2) {
    const ends = [facets[f], facets[f + 1]].map((v): [number, number] => [vertices[3 * v], vertices[3 * v + 1]]);
    if (ends[0][0] > ends[1][0]) ends.reverse();
    const [[r0, z0], [r1, z1]] = ends;
    if (r1 <= 0) continue;
    const share = r0 < 0 ? -r0 / (r1 - r0) : 0;
    const line = [
      [r0 + share * (r1 - r0), z0 + share * (z1 - z0)],
      [r1, z1],
    ];
    for (let k = 0; k < sectors; ++k) {
      const begin = places.length / 3;
      for (const angle of [k, k + 1].map((at) => (at * turn) / sectors))
        for (const [r, z] of line) places.push(r * Math.cos(angle), z, -r * Math.sin(angle));
      corners.push(begin, begin + 2, begin + 1, begin + 1, begin + 2, begin + 3);
    }
  }
  return { vertices: Float32Array.from(places), facets: Uint32Array.from(corners) };
}
