/** What the page and the program say to each other; docs/view_protocol.md describes it. */

export interface Part {
  name: string;
  body: string;
  kind: "skin" | "cells";
  first_vertex: number;
  num_vertices: number;
  num_triangles: number;
  num_edges: number;
}

export interface Field {
  name: string;
  label: string;
  unit: string;
}

export type Vector = [number, number, number];

export interface State {
  youngs_modulus: number; // [Pa]
  poissons_ratio: number;
  law: string;
  damping: number; // [1/s]
  gravity: Vector; // [m/s^2]
  time_step: number; // [s]
  speed: number;
  max_force: number; // [N]
  ground: boolean;
  ground_height: number; // [m]
  paused: boolean;
  pinned: number[];
  grabbed_by: number | null;
  poking: boolean;
  newton_limit: number;
  tolerance: number;
  warnings: string[];
}

export interface Header {
  title: string;
  version: string;
  dimension: 2 | 3;
  extent: number; // [m]
  up: Vector;
  eye?: Vector; // from the scene to the eye, at first
  gravity: Vector;
  parts: Part[];
  fields: Field[];
  client?: number; // live
  controls?: State; // live
  laws?: { name: string; label: string }[]; // live
  ground?: number | null; // [m] along `up`, of a recording
}

export interface Status {
  time: number;
  real_time_ratio: number;
  step_ms: number;
  assembly_ms: number;
  solve_ms: number;
  surface_ms: number;
  other_ms: number;
  newton_iterations: number;
  linear_iterations: number;
  residual: number; // [N]
  relative_residual: number;
  min_volume_ratio: number;
  inverted_cells: number;
  converged: boolean;
  at_rest: boolean;
  elastic_energy: number; // [J]
  kinetic_energy: number; // [J]
  words: string;
}

export interface Topology {
  triangles: Uint32Array[]; // by part, vertices numbered over all parts
  edges: Uint32Array[];
  restPositions: Float32Array;
}

/** One state of the surface as it is drawn. */
export interface Frame {
  number: number;
  time: number; // [s]
  answersDrag: number;
  field: number; // place in the header's list; -1: none
  least: number; // values that 1 and 65535 stand for
  greatest: number;
  positions: Float32Array;
  normals: Int8Array | null; // octahedral
  fieldValues: Uint16Array | null;
}

const TOPOLOGY = 0x31545352; // "RST1"
const FRAME = 0x31465352; // "RSF1"

const aligned = (offset: number) => (offset + 3) & ~3;

export function decodeTopology(buffer: ArrayBuffer, parts: Part[]): Topology {
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== TOPOLOGY) throw new Error("The topology does not begin with RST1.");
  if (view.getUint32(4, true) !== parts.length) throw new Error("The topology has other parts than the header.");
  const triangles: Uint32Array[] = [];
  const edges: Uint32Array[] = [];
  let offset = 8;
  const take = (count: number) => {
    const values = new Uint32Array(buffer, offset, count);
    offset += 4 * count;
    return values;
  };
  for (const part of parts) {
    triangles.push(take(3 * part.num_triangles));
    edges.push(take(2 * part.num_edges));
  }
  return { triangles, edges, restPositions: new Float32Array(buffer, offset, 3 * vertexCount(parts)) };
}

export function vertexCount(parts: Part[]): number {
  return parts.reduce((sum, part) => sum + part.num_vertices, 0);
}

export function isFrame(buffer: ArrayBuffer): boolean {
  return buffer.byteLength >= 64 && new DataView(buffer).getUint32(0, true) === FRAME;
}

/** Writes the places of the frame into `positions` [m] and points into `buffer` for the rest. */
export function decodeFrame(buffer: ArrayBuffer, positions: Float32Array): Frame {
  const view = new DataView(buffer);
  const vertices = view.getUint32(20, true);
  const flags = view.getUint32(24, true);
  if (3 * vertices !== positions.length) throw new Error("A frame has another number of vertices than the header.");
  const float = (offset: number) => view.getFloat32(offset, true);
  const [x, y, z] = [float(32), float(36), float(40)];
  const [dx, dy, dz] = [float(44) / 65535, float(48) / 65535, float(52) / 65535];
  const places = new Uint16Array(buffer, 64, 3 * vertices);
  for (let i = 0; i < places.length; i += 3) {
    positions[i] = x + dx * places[i];
    positions[i + 1] = y + dy * places[i + 1];
    positions[i + 2] = z + dz * places[i + 2];
  }
  let offset = aligned(64 + 6 * vertices);
  let normals: Int8Array | null = null;
  if (flags & 1) {
    normals = new Int8Array(buffer, offset, 2 * vertices);
    offset = aligned(offset + 2 * vertices);
  }
  const fieldValues = flags & 2 ? new Uint16Array(buffer, offset, vertices) : null;
  return {
    number: view.getUint32(4, true),
    time: view.getFloat64(8, true),
    answersDrag: view.getUint32(16, true),
    field: fieldValues ? view.getUint32(28, true) : -1,
    least: float(56),
    greatest: float(60),
    positions,
    normals,
    fieldValues,
  };
}

export function acknowledgement(frame: number): ArrayBuffer {
  const message = new DataView(new ArrayBuffer(8));
  message.setUint8(0, 1);
  message.setUint32(4, frame, true);
  return message.buffer;
}

export function dragMessage(number: number, target: { x: number; y: number; z: number }): ArrayBuffer {
  const message = new DataView(new ArrayBuffer(20));
  message.setUint8(0, 2);
  message.setUint32(4, number, true);
  message.setFloat32(8, target.x, true);
  message.setFloat32(12, target.y, true);
  message.setFloat32(16, target.z, true);
  return message.buffer;
}
