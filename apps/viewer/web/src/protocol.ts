/**
 * Messages between the page and the program, in both directions: the types, and the one place where bytes and
 * texts become values of them. docs/view_protocol.md describes it.
 */

import {
  either,
  flag,
  list,
  measurement,
  nullable,
  number,
  object,
  optional,
  record,
  tagged,
  text,
  vector,
  word,
  type Read,
  type Vector,
} from "./decode";

export type { Vector };

// Messages of the program: headers, and the messages of a live scene.

const part = object({
  name: text,
  body: text,
  kind: word("skin", "cells"),
  first_vertex: number,
  num_vertices: number,
  num_triangles: number,
  num_edges: number,
  num_tetrahedra: optional(number), // number of tetrahedra of its inside, for a cut
});
export type Part = Read<typeof part>;

export const readField = object({
  name: text,
  label: text,
  unit: text,
  group: optional(text),
  scale: optional(number), // scale of its values in the scene: what is far below is rounding
});
export type Field = Read<typeof readField>;

const collider = object({
  name: text,
  num_vertices: number,
  num_facets: number,
  closed: flag, // has an inside
  endless: flag, // a half-space
});
export type Collider = Read<typeof collider>;

/** Mark of a boundary condition, load or probe, at vertices. */
const mark = object({
  kind: word("support", "load", "probe"),
  name: text,
  vertices: list(number),
  directions: optional(list(vector)), // directions of a load: its force at each vertex over the greatest
  greatest: optional(number), // greatest of these forces [N]
  course: optional(object({ over: word("time", "load"), at: list(number), factors: list(number) })),
});
export type Mark = Read<typeof mark>;

/** A joint, spring or cable: lines between points, and dots at some of them. */
const connector = object({
  kind: text, // as in the scene: "hinge", "spring", "cable"
  name: text,
  points: list(
    object({
      at: optional(vector), // a point of the ground [m]
      vertices: optional(list(number)), // else the weighted sum of these
      weights: optional(list(number)),
    }),
  ),
  lines: list(list(number)), // pairs of points
  dots: list(number),
});
export type Connector = Read<typeof connector>;

/** Header of a live scene and of a recording. */
const headerShape = {
  title: text,
  version: text,
  dimension: word(2, 3),
  extent: number, // [m]
  up: vector,
  eye: optional(vector), // from the scene to the eye, at first
  gravity: vector,
  parts: list(part),
  fields: list(readField),
  colliders: optional(list(collider)),
  marks: optional(list(mark)),
  connectors: optional(list(connector)),
  axisymmetric: optional(flag), // in 2D: the half section of a body of revolution about the y axis
  forces_per_metre: optional(flag), // in 2D: forces and energies are those of a metre of depth; if it is not there, too
};

export const readHeader = object({
  ...headerShape,
  ground: optional(nullable(number)), // [m] along `up`, of a recording
});
export type Header = Read<typeof readHeader>;

const controlShape = { key: text, folder: text, label: text, help: text, of_body: optional(flag) };
const control = tagged("kind", {
  slider: object({
    ...controlShape,
    unit: text,
    least: number,
    greatest: number,
    step: number,
    zero: optional(text), // meaning of 0, in words
  }),
  log_slider: object({ ...controlShape, unit: text, least: number, greatest: number }),
  switch: object({ ...controlShape, hotkey: text }), // "": none
  choice: object({ ...controlShape, options: list(object({ name: text, label: text })) }),
  arrow: object({ ...controlShape, unit: text, greatest: number, step: number, initial: vector }),
});
export type Control = Read<typeof control>;
export type ControlOf<K extends Control["kind"]> = Extract<Control, { kind: K }>;

/** Value of a control of each kind. */
export const valueReaders = { slider: number, log_slider: number, switch: flag, choice: text, arrow: vector };
const controlValue = either(number, flag, text, vector);
export type ControlValue = Read<typeof controlValue>;
export type ControlValues = Record<string, ControlValue>; // by the key of the control

const stateShape = {
  values: record(controlValue),
  paused: flag,
  ground: nullable(number), // [m] along `up`; null: there is none
  pinned: list(number),
  held: list(object({ vertices: list(number) })), // faces that somebody holds, at some of their vertices
  grabbed_by: nullable(number),
  poking: flag,
  bodies: optional(list(record(controlValue))), // controls of each body, in the order of the parts
  loads: optional(list(object({ vertices: list(number), directions: list(vector) }))), // loads that were put on faces on the page
  warnings: list(text),
};
const state = object(stateShape);
export type State = Read<typeof state>;

const status = object({
  time: number,
  real_time_ratio: measurement,
  step_ms: measurement,
  assembly_ms: measurement,
  solve_ms: measurement,
  surface_ms: measurement,
  other_ms: measurement,
  newton_iterations: number,
  linear_iterations: number,
  residual: measurement, // [N]
  relative_residual: measurement,
  min_volume_ratio: measurement,
  inverted_cells: number,
  smallest_gap: nullable(number), // [m]; null: nothing is near
  active_pairs: nullable(number), // null: nothing can touch
  converged: flag,
  at_rest: flag,
  elastic_energy: measurement, // [J]
  kinetic_energy: measurement, // [J]
  hand_force: optional(nullable(measurement)), // [N]; null: nothing is held
  words: text,
  drives: optional(record(number)), // present values of motors and cables, by the keys of their controls
  warnings: optional(list(text)), // warnings beside the state: cells too coarse or inverted
});
export type Status = Read<typeof status>;

const serverMessage = tagged("type", {
  hello: object({ ...headerShape, client: number, saves: flag, controls: list(control), state }),
  state,
  status,
  error: object({ message: text }),
  note: object({ message: text }), // confirms that a request is done
});
export type ServerMessage = Read<typeof serverMessage>;
export type Hello = Extract<ServerMessage, { type: "hello" }>;

export function decodeMessage(json: string): ServerMessage {
  return serverMessage(JSON.parse(json), "message of the program");
}

// Topologies and frames.

export interface Topology {
  triangles: Uint32Array[]; // by part, vertices numbered over all parts
  edges: Uint32Array[];
  tetrahedra: Uint32Array[]; // tetrahedra of the inside; vertices without a triangle stand behind those of the surface
  restPositions: Float32Array;
  colliders: ColliderShape[];
}

/** A collider as it was made; each facet has as many corners as the scene has dimensions, and may repeat one. */
export interface ColliderShape {
  vertices: Float32Array; // [m]
  facets: Uint32Array;
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
  colliders: Float32Array | null; // where they are, 12 numbers each
  load?: number; // factor, of recordings
  arrows?: Arrows | null;
}

/** Vectors at the vertices. */
export interface Arrows {
  field: number; // place of their length in the header's list
  greatest: number | null; // largest length over all frames; null: that of this frame alone is known
  vectors: Float32Array; // three numbers for each vertex
}

const TOPOLOGY = 0x31545352; // "RST1"
const FRAME = 0x31465352; // "RSF1"

const aligned = (offset: number) => (offset + 3) & ~3;

type Drawn = Pick<Header, "parts" | "colliders" | "dimension">;

export function decodeTopology(buffer: ArrayBuffer, { parts, colliders = [], dimension }: Drawn): Topology {
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== TOPOLOGY) throw new Error("The topology does not begin with RST1.");
  if (view.getUint32(4, true) !== parts.length)
    throw new Error("The parts of the topology differ from those of the header.");
  const triangles: Uint32Array[] = [];
  const edges: Uint32Array[] = [];
  const tetrahedra: Uint32Array[] = [];
  let offset = 8;
  const take = (count: number) => {
    const values = new Uint32Array(buffer, offset, count);
    offset += 4 * count;
    return values;
  };
  for (const part of parts) {
    triangles.push(take(3 * part.num_triangles));
    edges.push(take(2 * part.num_edges));
    tetrahedra.push(take(4 * (part.num_tetrahedra ?? 0)));
  }
  const takePlaces = (count: number) => {
    const places = new Float32Array(buffer, offset, 3 * count);
    offset += 12 * count;
    return places;
  };
  const restPositions = takePlaces(vertexCount(parts));
  const shapes = colliders.map(({ num_vertices, num_facets }) => ({
    vertices: takePlaces(num_vertices),
    facets: take(dimension * num_facets),
  }));
  return { triangles, edges, tetrahedra, restPositions, colliders: shapes };
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
  if (3 * vertices !== positions.length)
    throw new Error("The number of vertices of a frame differs from that of the header.");
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
  if (fieldValues) offset = aligned(offset + 2 * vertices);
  const arrows = flags & 8 ? decodeArrows(buffer, offset, vertices) : null;
  if (arrows) offset += 8 + aligned(6 * vertices);
  const colliders = flags & 4 ? new Float32Array(buffer, offset) : null;
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
    colliders,
    arrows,
  };
}

function decodeArrows(buffer: ArrayBuffer, offset: number, vertices: number): Arrows {
  const view = new DataView(buffer);
  const scale = view.getFloat32(offset + 4, true) / 32767;
  const vectors = Float32Array.from(new Int16Array(buffer, offset + 8, 3 * vertices), (step) => scale * step);
  return { field: view.getUint32(offset, true), greatest: null, vectors };
}

// Messages of the page.

export interface Point {
  x: number; // [m]
  y: number;
  z: number;
}

export type PageMessage =
  | { type: "acknowledge"; frame: number }
  | { type: "drag"; number: number; target: Point }
  | { type: "grab"; vertex: number; point: Vector }
  | { type: "release" }
  | { type: "pin" | "unpin"; vertex: number }
  | { type: "unpin_all" | "free_faces" | "save" }
  | { type: "hold"; vertex: number; point: Vector; angle: number; radius: number }
  | { type: "poke"; center: Vector; radius: number }
  | { type: "poke_end" }
  | { type: "set"; key: string; value: ControlValue; body?: number }
  | { type: "field"; name: string; arrows?: string } // "": none
  | { type: "settle" } // to the equilibrium
  | {
      type: "load";
      vertex: number;
      point: Vector;
      angle: number;
      radius: number;
      kind: "force" | "pressure";
      value: number;
    }
  | { type: "remove_loads" }
  | { type: "pause" | "play" | "step" | "reset" | "reload" };

/** Acknowledgements and drags, which are many, as bytes; the others as JSON. */
export function encodeMessage(message: PageMessage): string | ArrayBuffer {
  switch (message.type) {
    case "acknowledge": {
      const bytes = new DataView(new ArrayBuffer(8));
      bytes.setUint8(0, 1);
      bytes.setUint32(4, message.frame, true);
      return bytes.buffer;
    }
    case "drag": {
      const bytes = new DataView(new ArrayBuffer(20));
      bytes.setUint8(0, 2);
      bytes.setUint32(4, message.number, true);
      bytes.setFloat32(8, message.target.x, true);
      bytes.setFloat32(12, message.target.y, true);
      bytes.setFloat32(16, message.target.z, true);
      return bytes.buffer;
    }
    default:
      return JSON.stringify(message);
  }
}
