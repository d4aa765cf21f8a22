/** Reads a recording: header, topology, and frames as differences; docs/view_protocol.md describes the format. */

import { decodeTopology, vertexCount, type Field, type Frame, type Header, type Topology } from "./protocol";

/** A recorded state, in whole units of the header's quantum. */
export interface RecordedFrame {
  number: number; // of the frame in report.json
  step: number;
  time: number; // [s]
  load: number;
  ranges: [number, number][]; // least and greatest value of each recorded field
  places: Int32Array;
  fields: Uint16Array[];
}

export interface Recording {
  header: Header;
  topology: Topology;
  restPlaces: Int32Array; // in units of the quantum, so that nothing has moved at rest
  frames: RecordedFrame[];
  skipped: number; // frames left out between two that are kept, because all would not fit
  damage: string; // in words; empty: the file ends where it should
}

const LARGEST = 1.2e9; // bytes of decoded frames that the page holds
const RECORDING = 0x31525352; // "RSR1"

/** `progress`: share of the file that has been read, 0 to 1. */
export async function readRecording(buffer: ArrayBuffer, progress: (share: number) => void): Promise<Recording> {
  const view = new DataView(buffer);
  if (buffer.byteLength < 12 || view.getUint32(0, true) !== RECORDING)
    throw new Error("This is not a recording: it does not begin with RSR1.");
  let offset = 4;
  const take = (what: string) => {
    const length = offset + 4 <= buffer.byteLength ? view.getUint32(offset, true) : Infinity;
    if (offset + 4 + length > buffer.byteLength) throw new Error(`The recording ends inside its ${what}.`);
    const bytes = buffer.slice(offset + 4, offset + 4 + length);
    offset += 4 + length;
    return bytes;
  };
  const header = JSON.parse(new TextDecoder().decode(take("header"))) as Header;
  const topology = decodeTopology(take("topology"), header.parts);

  const records = recordsFrom(view, offset);
  const numVertices = vertexCount(header.parts);
  const bytesPerFrame = numVertices * (12 + 2 * header.fields.length);
  const stride = Math.max(1, Math.ceil((records.length * bytesPerFrame) / LARGEST));
  const decoder = new Decoder(header, topology, numVertices);
  const frames: RecordedFrame[] = [];
  let damage = records.length > 0 || offset === buffer.byteLength ? "" : "The recording ends inside its first frame.";
  for (const [i, record] of records.entries()) {
    const payload = new Uint8Array(buffer, record.begin, record.length);
    if (crc32(payload) !== record.checksum) {
      damage = `The recording is damaged after ${i} frames; what lies behind is left out.`;
      break;
    }
    const frame = await decoder.decode(payload);
    if (i % stride === 0 || i === records.length - 1) frames.push(frame);
    progress((i + 1) / records.length);
  }
  return { header, topology, restPlaces: decoder.restPlaces, frames, skipped: stride - 1, damage };
}

/** Where the whole records lie; one that the end of the file cuts off is left out. */
function recordsFrom(view: DataView, first: number): { begin: number; length: number; checksum: number }[] {
  const records = [];
  let offset = first;
  while (offset + 8 <= view.byteLength) {
    const length = view.getUint32(offset, true);
    if (offset + 8 + length > view.byteLength) break;
    records.push({ begin: offset + 8, length, checksum: view.getUint32(offset + 4, true) });
    offset += 8 + length;
  }
  return records;
}

class Decoder {
  readonly restPlaces: Int32Array;
  private last: Int32Array;
  private readonly numFields: number;

  constructor(
    header: Header,
    topology: Topology,
    private readonly numVertices: number,
  ) {
    this.numFields = header.fields.length;
    // Halves are rounded away from zero, as the writer does.
    const quantum = header.quantum!;
    const rounded = (x: number) => Math.sign(x) * Math.round(Math.abs(x) / quantum);
    this.last = this.restPlaces = Int32Array.from(topology.restPositions, rounded);
  }

  async decode(payload: Uint8Array): Promise<RecordedFrame> {
    const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
    const ranges: [number, number][] = [];
    for (let i = 0; i < this.numFields; ++i)
      ranges.push([view.getFloat32(24 + 8 * i, true), view.getFloat32(28 + 8 * i, true)]);
    const bytes = await inflated(payload.subarray(24 + 8 * this.numFields));
    const count = 3 * this.numVertices;
    const expected = 4 * count + 2 * this.numVertices * this.numFields;
    if (bytes.length !== expected) throw new Error(`A frame holds ${bytes.length} bytes, expected ${expected}.`);
    const places = new Int32Array(count);
    for (let i = 0; i < count; ++i) {
      const code = bytes[i] | (bytes[count + i] << 8) | (bytes[2 * count + i] << 16) | (bytes[3 * count + i] << 24);
      places[i] = this.last[i] + ((code >>> 1) ^ -(code & 1));
    }
    this.last = places;
    const fields: Uint16Array[] = [];
    for (let f = 0; f < this.numFields; ++f) {
      const begin = 4 * count + 2 * this.numVertices * f;
      const values = new Uint16Array(this.numVertices);
      for (let i = 0; i < values.length; ++i) values[i] = bytes[begin + i] | (bytes[begin + values.length + i] << 8);
      fields.push(values);
    }
    return {
      number: view.getUint32(0, true),
      step: view.getUint32(4, true),
      time: view.getFloat64(8, true),
      load: view.getFloat64(16, true),
      ranges,
      places,
      fields,
    };
  }
}

async function inflated(bytes: Uint8Array): Promise<Uint8Array> {
  const stream = new Blob([bytes as Uint8Array<ArrayBuffer>]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});

function crc32(bytes: Uint8Array): number {
  let c = 0xffffffff;
  for (const byte of bytes) c = crcTable[(c ^ byte) & 0xff] ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

/** What the results page shows of a recording: the recorded fields, and the displacement formed from the places. */
export class RecordedValues {
  readonly fields: Field[];
  private readonly positions: Float32Array;
  private readonly lengths: Uint16Array;
  private greatestDisplacement: number | null = null;

  constructor(readonly recording: Recording) {
    const recorded = recording.header.fields;
    this.fields = [{ name: "displacement", label: "displacement", unit: "m" }, ...recorded];
    this.positions = new Float32Array(recording.restPlaces.length);
    this.lengths = new Uint16Array(recording.restPlaces.length / 3);
  }

  /** `field`: place in `fields`; -1: none. */
  frame(index: number, field: number): Frame {
    const { frames, header } = this.recording;
    const recorded = frames[index];
    const quantum = header.quantum!;
    for (let i = 0; i < this.positions.length; ++i) this.positions[i] = quantum * recorded.places[i];
    const [least, greatest] = field < 0 ? [0, 1] : this.rangeOfFrame(index, field);
    const fieldValues =
      field < 0 ? null : field === 0 ? this.displacementCodes(index, greatest) : recorded.fields[field - 1];
    return {
      number: index,
      time: recorded.time,
      answersDrag: 0,
      field,
      least,
      greatest,
      positions: this.positions,
      normals: null,
      fieldValues,
    };
  }

  private displacementCodes(index: number, greatest: number): Uint16Array {
    const scale = greatest > 0 ? 65534 / greatest : 0;
    for (let v = 0; v < this.lengths.length; ++v) {
      const length = this.displacement(index, v)[3];
      this.lengths[v] = 1 + Math.min(65534, Math.round(scale * length));
    }
    return this.lengths;
  }

  rangeOfFrame(index: number, field: number): [number, number] {
    if (field > 0) return this.recording.frames[index].ranges[field - 1];
    let greatest = 0;
    for (let v = 0; v < this.lengths.length; ++v) greatest = Math.max(greatest, this.displacement(index, v)[3]);
    return [0, greatest];
  }

  /** Over all frames. */
  range(field: number): [number, number] {
    const { frames } = this.recording;
    if (field > 0) {
      const known = frames.map((frame) => frame.ranges[field - 1]).filter((range) => range.every(Number.isFinite));
      return [Math.min(...known.map((range) => range[0])), Math.max(...known.map((range) => range[1]))];
    }
    this.greatestDisplacement ??= Math.max(...frames.map((_, i) => this.rangeOfFrame(i, 0)[1]));
    return [0, this.greatestDisplacement];
  }

  /** Components and length [m]. */
  displacement(index: number, vertex: number): [number, number, number, number] {
    const { places } = this.recording.frames[index];
    const { restPlaces: rest, header } = this.recording;
    const quantum = header.quantum!;
    const x = quantum * (places[3 * vertex] - rest[3 * vertex]);
    const y = quantum * (places[3 * vertex + 1] - rest[3 * vertex + 1]);
    const z = quantum * (places[3 * vertex + 2] - rest[3 * vertex + 2]);
    return [x, y, z, Math.sqrt(x * x + y * y + z * z)];
  }

  /** The value of a recorded field (place in `fields`, from 1); NaN where there is none. */
  value(index: number, field: number, vertex: number): number {
    const frame = this.recording.frames[index];
    const code = frame.fields[field - 1][vertex];
    const [least, greatest] = frame.ranges[field - 1];
    return code === 0 ? NaN : least + ((code - 1) / 65534) * (greatest - least);
  }
}
