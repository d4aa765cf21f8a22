/**
 * Reads a recording: header, topology, and frames as differences; docs/view_protocol.md describes the
 * format.
 */

import { NUMBERS } from "./colliders";
import { decodeTopology, type Header, readHeader, type Topology, vertexCount } from "./protocol";

/** A recorded state. */
export interface RecordedFrame {
  number: number; // number of the frame in report.json
  step: number;
  time: number; // [s]
  load: number;
  ranges: [number, number][]; // least and greatest value of each recorded field
  displacements: Float32Array; // from the rest places [m]
  colliders: Float32Array; // where they are, 12 numbers each
  fields: Uint16Array[]; // 0: not a number; 1 to 65535: from the least to the greatest value
}

export interface Recording {
  header: Header;
  topology: Topology;
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
  const header = readHeader(JSON.parse(new TextDecoder().decode(take("header"))), "header of the recording");
  const topology = decodeTopology(take("topology"), header);

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
      damage = `The recording is damaged after ${i} frames; later frames are not shown.`;
      break;
    }
    const frame = await decoder.decode(payload);
    if (i % stride === 0 || i === records.length - 1) frames.push(frame);
    progress((i + 1) / records.length);
  }
  return { header, topology, frames, skipped: stride - 1, damage };
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

const LEVELS = 4095; // levels of a recorded field

/** For each vertex the highest of its neighbours with lower numbers; -1 without any. */
export function lowerNeighbours(topology: Topology, numVertices: number): Int32Array {
  const neighbours = new Int32Array(numVertices).fill(-1);
  const connect = (a: number, b: number) => {
    const [low, high] = a < b ? [a, b] : [b, a];
    if (low < high) neighbours[high] = Math.max(neighbours[high], low);
  };
  for (const corners of topology.triangles)
    for (let i = 0; i < corners.length; i += 3) {
      connect(corners[i], corners[i + 1]);
      connect(corners[i + 1], corners[i + 2]);
      connect(corners[i + 2], corners[i]);
    }
  for (const corners of topology.tetrahedra)
    for (let i = 0; i < corners.length; i += 4)
      for (let a = i; a < i + 4; ++a) for (let b = a + 1; b < i + 4; ++b) connect(corners[a], corners[b]);
  for (const ends of topology.edges) for (let i = 0; i < ends.length; i += 2) connect(ends[i], ends[i + 1]);
  return neighbours;
}

class Decoder {
  private readonly displacements: Float64Array; // displacements of the last frame, x of all vertices, then y, then z [m]
  private readonly neighbours: Int32Array;
  private readonly numFields: number;
  private readonly numNumbers: number; // count of the numbers of colliders

  constructor(
    header: Header,
    topology: Topology,
    private readonly numVertices: number,
  ) {
    this.numFields = header.fields.length;
    this.numNumbers = NUMBERS * topology.colliders.length;
    this.displacements = new Float64Array(3 * numVertices);
    this.neighbours = lowerNeighbours(topology, numVertices);
  }

  async decode(payload: Uint8Array): Promise<RecordedFrame> {
    const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
    const quantum = view.getFloat64(24, true);
    const ranges: [number, number][] = [];
    for (let i = 0; i < this.numFields; ++i)
      ranges.push([view.getFloat32(32 + 8 * i, true), view.getFloat32(36 + 8 * i, true)]);
    const begin = 32 + 8 * this.numFields;
    const colliders = Float32Array.from({ length: this.numNumbers }, (_, i) => view.getFloat32(begin + 4 * i, true));
    const bytes = await inflated(payload.subarray(begin + 4 * this.numNumbers));
    const n = this.numVertices;
    const expected = n * (12 + 2 * this.numFields);
    if (bytes.length !== expected) throw new Error(`A frame holds ${bytes.length} bytes, expected ${expected}.`);
    const unfolded = (code: number) => (code >>> 1) ^ -(code & 1);
    const displacements = new Float32Array(3 * n);
    const steps = new Int32Array(n);
    for (let k = 0; k < 3; ++k)
      for (let v = 0, i = k * n; v < n; ++v, ++i) {
        const code = bytes[i] | (bytes[3 * n + i] << 8) | (bytes[6 * n + i] << 16) | (bytes[9 * n + i] << 24);
        const neighbour = this.neighbours[v];
        steps[v] = unfolded(code) + (neighbour < 0 ? 0 : steps[neighbour]);
        displacements[3 * v + k] = this.displacements[i] += quantum * steps[v];
      }
    const fields: Uint16Array[] = [];
    for (let f = 0; f < this.numFields; ++f) {
      const begin = n * (12 + 2 * f);
      const values = new Uint16Array(n);
      for (let v = 0; v < n; ++v) {
        const neighbour = this.neighbours[v];
        steps[v] = unfolded(bytes[begin + v] | (bytes[begin + n + v] << 8)) + (neighbour < 0 ? 0 : steps[neighbour]);
        values[v] = steps[v] === 0 ? 0 : 1 + Math.round(((steps[v] - 1) * 65534) / (LEVELS - 1));
      }
      fields.push(values);
    }
    return {
      number: view.getUint32(0, true),
      step: view.getUint32(4, true),
      time: view.getFloat64(8, true),
      load: view.getFloat64(16, true),
      ranges,
      displacements,
      colliders,
      fields,
    };
  }
}

export async function inflated(bytes: Uint8Array): Promise<Uint8Array> {
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
