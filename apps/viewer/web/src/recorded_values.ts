/**
 * Values on the results page: fields that it holds, that are formed from the places, or that
 * are fetched.
 */

import { type Arrows, type Field, type Frame, vertexCount } from "./protocol";
import type { RecordedFrame, Recording } from "./recording";

/** A field at the vertices, frame by frame of a recording. */
export interface FieldFrames {
  ranges: [number, number][]; // values that 1 and 65535 stand for
  shown?: [number, number][]; // least and greatest value, where these are others
  codes: Uint16Array[]; // 0: not a number; 1 to 65535: from the least to the greatest value
}

/**
 * Fields that a recording does not hold, and the bytes of one of them (docs/view_protocol.md, "Fields on
 * demand").
 */
export interface OtherFields {
  fields: Field[];
  fetch(name: string): Promise<ArrayBuffer>;
}

const VALUES = 0x31565352; // "RSV1"

/** The frames of a field in the order of `frames`; one that is not there holds no number. */
export function decodeFieldFrames(buffer: ArrayBuffer, frames: RecordedFrame[], numVertices: number): FieldFrames {
  const view = new DataView(buffer);
  if (buffer.byteLength < 12 || view.getUint32(0, true) !== VALUES)
    throw new Error("The values of the field do not begin with RSV1.");
  if (view.getUint32(4, true) !== numVertices)
    throw new Error("The values of the field are those of another surface than the recording's.");
  const size = 12 + 2 * (numVertices + (numVertices % 2));
  const places = new Map<number, number>(); // number of a frame -> where it lies
  for (let offset = 12; offset + size <= buffer.byteLength; offset += size)
    places.set(view.getUint32(offset, true), offset);
  const found: FieldFrames = { ranges: [], codes: [] };
  for (const { number } of frames) {
    const offset = places.get(number);
    found.ranges.push(
      offset === undefined ? [NaN, NaN] : [view.getFloat32(offset + 4, true), view.getFloat32(offset + 8, true)],
    );
    found.codes.push(
      offset === undefined ? new Uint16Array(numVertices) : new Uint16Array(buffer, offset + 12, numVertices),
    );
  }
  return found;
}

/**
 * The length of the displacement, or one of its components. Its range is that of the cells, as in the report: skins
 * stand out of them.
 */
function displacementFrames(frames: RecordedFrame[], component: number, isOfCells: Uint8Array): FieldFrames {
  const found: FieldFrames & { shown: [number, number][] } = { ranges: [], shown: [], codes: [] };
  for (const { displacements } of frames) {
    const values = new Float32Array(displacements.length / 3);
    let [least, greatest] = [Infinity, -Infinity];
    let [low, high] = [Infinity, -Infinity];
    for (let v = 0; v < values.length; ++v) {
      const value =
        component < 0
          ? Math.hypot(displacements[3 * v], displacements[3 * v + 1], displacements[3 * v + 2])
          : displacements[3 * v + component];
      values[v] = value;
      least = Math.min(least, value);
      greatest = Math.max(greatest, value);
      if (!isOfCells[v]) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    const scale = greatest > least ? 65534 / (greatest - least) : 0;
    found.ranges.push([least, greatest]);
    found.shown.push(low <= high ? [low, high] : [least, greatest]);
    found.codes.push(Uint16Array.from(values, (value) => 1 + Math.min(65534, Math.round(scale * (value - least)))));
  }
  return found;
}

export class RecordedValues {
  /**
   * The displacement first, then what is recorded, the displacement's components, and what can be fetched.
   */
  readonly fields: Field[];
  private readonly numRecorded: number;
  private readonly numOwn: number;
  private readonly positions: Float32Array;
  private readonly held = new Map<number, FieldFrames>(); // by place in `fields`
  private readonly isOfCells: Uint8Array; // by vertex: of the cells, not of a skin

  constructor(
    readonly recording: Recording,
    private readonly others: OtherFields | null = null,
  ) {
    const { header, topology } = recording;
    this.isOfCells = new Uint8Array(topology.restPositions.length / 3);
    for (const { kind, first_vertex: first, num_vertices: count } of header.parts)
      if (kind === "cells") this.isOfCells.fill(1, first, first + count);
    const displacement = { unit: "m", group: "displacement", scale: header.extent };
    const components = (header.dimension === 2 ? ["x", "y"] : ["x", "y", "z"]).map((axis) => ({
      ...displacement,
      name: `displacement.${axis}`,
      label: `displacement ${axis}`,
    }));
    const own = [{ ...displacement, name: "displacement", label: "displacement" }, ...header.fields, ...components];
    const names = new Set(own.map((field) => field.name));
    this.fields = [...own, ...(others?.fields ?? []).filter((field) => !names.has(field.name))];
    this.numRecorded = header.fields.length;
    this.numOwn = own.length;
    this.positions = new Float32Array(topology.restPositions.length);
  }

  /** Whether a field (place in `fields`) can be shown at once. */
  isReady(field: number): boolean {
    return field < this.numOwn || this.held.has(field);
  }

  /** Fetches what is not there yet. */
  async load(field: number): Promise<void> {
    if (this.isReady(field) || !this.others) return;
    const buffer = await this.others.fetch(this.fields[field].name);
    const { frames, header } = this.recording;
    this.held.set(field, decodeFieldFrames(buffer, frames, vertexCount(header.parts)));
  }

  private of(field: number): FieldFrames {
    const held = this.held.get(field);
    if (held) return held;
    const { frames } = this.recording;
    const recorded = field - 1;
    const component = "xyz".indexOf(this.fields[field].name.split(".")[1] ?? "-");
    const formed: FieldFrames =
      recorded >= 0 && recorded < this.numRecorded
        ? {
            ranges: frames.map((frame) => frame.ranges[recorded]),
            codes: frames.map((frame) => frame.fields[recorded]),
          }
        : displacementFrames(frames, component, this.isOfCells);
    this.held.set(field, formed);
    return formed;
  }

  /**
   * `field`: place in `fields`; -1: none. `swing`: how much of what the frame has moved beyond the first one is seen;
   * values stay those of the whole. `scale`: how many times the displacement is drawn.
   */
  frame(index: number, field: number, swing = 1, scale = 1): Frame {
    const { frames, topology } = this.recording;
    const recorded = frames[index];
    const first = frames[0].displacements;
    for (let i = 0; i < this.positions.length; ++i) {
      const moved = recorded.displacements[i];
      const shown = swing === 1 ? moved : first[i] + swing * (moved - first[i]);
      this.positions[i] = topology.restPositions[i] + scale * shown;
    }
    const [least, greatest] = field < 0 ? [0, 1] : this.of(field).ranges[index];
    return {
      number: index,
      time: recorded.time,
      answersDrag: 0,
      field,
      least,
      greatest,
      positions: this.positions,
      normals: null,
      fieldValues: field < 0 ? null : this.of(field).codes[index],
      colliders: recorded.colliders,
      load: recorded.load,
    };
  }

  /** Places in `fields` of the components of a vector, in the order of the axes. */
  private componentsOf(name: string): number[] {
    const places = [..."xyz"].map((axis) => this.fields.findIndex((field) => field.name === `${name}.${axis}`));
    return places.filter((place) => place >= 0);
  }

  /** Fetches the components of a vector that are not there yet; null: all are. */
  loadVectors(name: string): Promise<unknown> | null {
    const missing = name === "" ? [] : this.componentsOf(name).filter((field) => !this.isReady(field));
    return missing.length === 0 ? null : Promise.all(missing.map((field) => this.load(field)));
  }

  /** The vectors of a field at the vertices; null where they are not there. */
  arrows(index: number, name: string): Arrows | null {
    const field = this.fields.findIndex((entry) => entry.name === name);
    const components = this.componentsOf(name);
    if (field < 0 || components.length === 0 || !components.every((place) => this.isReady(place))) return null;
    const vectors = new Float32Array(this.positions.length);
    components.forEach((place, k) => {
      for (let v = 0; v < vectors.length / 3; ++v) vectors[3 * v + k] = this.value(index, place, v) || 0;
    });
    return { field, greatest: this.largestLength(name, components), vectors };
  }

  /** The largest length of a vector over all frames. */
  private largestLength(name: string, components: number[]): number {
    const known = this.lengths.get(name);
    if (known !== undefined) return known;
    let largest = 0;
    for (let index = 0; index < this.recording.frames.length; ++index)
      for (let v = 0; v < this.positions.length / 3; ++v) {
        const square = components.reduce((sum, place) => sum + (this.value(index, place, v) || 0) ** 2, 0);
        largest = Math.max(largest, square);
      }
    this.lengths.set(name, Math.sqrt(largest));
    return Math.sqrt(largest);
  }

  private readonly lengths = new Map<string, number>(); // by the names of vectors

  rangeOfFrame(index: number, field: number): [number, number] {
    const { ranges, shown = ranges } = this.of(field);
    return shown[index];
  }

  /**
   * The frame that tells most: where the field of this place in `fields` is largest, the last of those; of fields that
   * are nothing anywhere the last frame.
   */
  mostTelling(field: number): number {
    const { length } = this.recording.frames;
    let best = length - 1;
    const size = (index: number) => {
      const [low, high] = this.rangeOfFrame(index, field);
      return Number.isFinite(low + high) ? Math.max(Math.abs(low), Math.abs(high)) : -1;
    };
    for (let i = length - 2; i >= 0; --i) if (size(i) > size(best) * (1 + 1e-6)) best = i;
    return best;
  }

  /** Over all frames. */
  range(field: number): [number, number] {
    const { ranges, shown = ranges } = this.of(field);
    const known = shown.filter((range) => range.every(Number.isFinite));
    return [Math.min(...known.map((range) => range[0])), Math.max(...known.map((range) => range[1]))];
  }

  /** The length of the largest displacement in all frames [m]. */
  get largestDisplacement(): number {
    const [low, high] = this.range(0);
    return Math.max(Math.abs(low), Math.abs(high));
  }

  /** Components and length [m]. */
  displacement(index: number, vertex: number): [number, number, number, number] {
    const { displacements } = this.recording.frames[index];
    const [x, y, z] = displacements.subarray(3 * vertex, 3 * vertex + 3);
    return [x, y, z, Math.sqrt(x * x + y * y + z * z)];
  }

  /** The value of a field (place in `fields`); NaN where there is none. */
  value(index: number, field: number, vertex: number): number {
    const { codes, ranges } = this.of(field);
    const code = codes[index][vertex];
    const [least, greatest] = ranges[index];
    return code === 0 ? NaN : least + ((code - 1) / 65534) * (greatest - least);
  }
}
