/** Writes small recordings as docs/view_protocol.md describes them: a beam of boxes that bends. */

import { deflateSync } from "node:zlib";
import { readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { lowerNeighbours } from "../src/recording";
import { webFolder } from "./harness";

export const QUANTUM = 2 ** -17; // about 1e-5 of the beam's length
const SOURCE = '<script id="source" type="application/json">{"kind": "live"}</script>';

export interface Beam {
  rest: Float32Array;
  triangles: Uint32Array;
  frames: { time: number; places: Float64Array; field: Float64Array }[];
}

/** A tube of square section along x, closed at its ends; frame f bends it by its share of `bend` [m]. */
export function bendingBeam(numFrames: number, bend: number): Beam {
  const along = 24;
  const ring = [-0.1, -0.1, 0.1, -0.1, 0.1, 0.1, -0.1, 0.1];
  const rest: number[] = [];
  for (let i = 0; i <= along; ++i) for (let k = 0; k < 4; ++k) rest.push(i / along, ring[2 * k], ring[2 * k + 1]);
  const triangles: number[] = [];
  for (let i = 0; i < along; ++i)
    for (let k = 0; k < 4; ++k) {
      const [a, b] = [4 * i + k, 4 * i + ((k + 1) % 4)];
      triangles.push(a, b + 4, b, a, a + 4, b + 4);
    }
  const end = 4 * along;
  triangles.push(0, 1, 2, 0, 2, 3, end, end + 2, end + 1, end, end + 3, end + 2);
  const restPlaces = Float32Array.from(rest);
  const frames = Array.from({ length: numFrames }, (_, f) => {
    const share = numFrames > 1 ? f / (numFrames - 1) : 1;
    const places = Float64Array.from(restPlaces);
    for (let v = 0; v < places.length; v += 3) places[v + 1] -= share * bend * places[v] ** 2;
    const field = Float64Array.from({ length: places.length / 3 }, (_, v) => share * (1 - restPlaces[3 * v]) * 1e4);
    return { time: 0.1 * f, places, field };
  });
  return { rest: restPlaces, triangles: Uint32Array.from(triangles), frames };
}

export function writeRecording(beam: Beam): Buffer {
  const header = {
    title: "Bending beam",
    version: "0.1.0",
    dimension: 3,
    extent: 1,
    up: [0, 1, 0],
    gravity: [0, -9.81, 0],
    parts: [
      {
        name: "beam",
        body: "beam",
        kind: "cells",
        first_vertex: 0,
        num_vertices: beam.rest.length / 3,
        num_triangles: beam.triangles.length / 3,
        num_edges: 0,
      },
    ],
    fields: [{ name: "von_mises", label: "von Mises stress", unit: "Pa" }],
  };
  const topology = Buffer.concat([bytesOf(Uint32Array.of(0x31545352, 1)), bytesOf(beam.triangles), bytesOf(beam.rest)]);
  const parts: Uint8Array[] = [
    Buffer.from("RSR1"),
    withLength(Buffer.from(JSON.stringify(header))),
    withLength(topology),
  ];
  const neighbours = lowerNeighbours(
    { triangles: [beam.triangles], edges: [], tetrahedra: [], restPositions: beam.rest, colliders: [] },
    beam.rest.length / 3,
  );
  const less = (numbers: number[], v: number) => numbers[v] - (neighbours[v] < 0 ? 0 : numbers[neighbours[v]]);
  const before = new Float64Array(beam.rest.length); // displacements that a reader has
  const steps = (places: Float64Array): Buffer => {
    const differences = [0, 1, 2].flatMap((k) => {
      const along = Array.from({ length: places.length / 3 }, (_, v) => {
        const i = 3 * v + k;
        const step = Math.round((places[i] - beam.rest[i] - before[i]) / QUANTUM);
        before[i] += QUANTUM * step;
        return step;
      });
      return along.map((_, v) => less(along, v));
    });
    return planes(differences, 4);
  };
  const levels = (field: Float64Array): Buffer => {
    const [least, greatest] = [Math.min(...field), Math.max(...field)];
    const all = [...field].map((value) => 1 + Math.round((4094 * (value - least)) / (greatest - least || 1)));
    return planes(
      all.map((_, v) => less(all, v)),
      2,
    );
  };
  beam.frames.forEach((frame, number) => {
    const payload = Buffer.concat([
      bytesOf(Uint32Array.of(number, number)),
      bytesOf(Float64Array.of(frame.time, 1, QUANTUM)),
      bytesOf(Float32Array.of(Math.min(...frame.field), Math.max(...frame.field))),
      deflateSync(Buffer.concat([steps(frame.places), levels(frame.field)])),
    ]);
    parts.push(bytesOf(Uint32Array.of(payload.length, crc32(payload))), payload);
  });
  return Buffer.concat(parts);
}

/** The bytes of all numbers, the lowest first. */
function planes(numbers: number[], count: number): Buffer {
  const bytes = Buffer.alloc(count * numbers.length);
  numbers.forEach((number, i) => {
    const code = number >= 0 ? 2 * number : -2 * number - 1;
    for (let k = 0; k < count; ++k) bytes[k * numbers.length + i] = Math.floor(code / 256 ** k) % 256;
  });
  return bytes;
}

/** The report that belongs to the recording. */
export function reportOf(beam: Beam): object {
  const frames = beam.frames.map((frame, step) => ({
    step,
    time: frame.time,
    load: 1,
    newton_iterations: 2,
    min_volume_ratio: 0.9,
    energy: { elastic: step, kinetic: 1, external: 0, total: step + 1 },
    probes: { tip: { displacement: [0, -0.01 * step, 0] } },
    reactions: { wall: [0, 5, 0] },
  }));
  return { status: "done", reason: "", title: "Bending beam", frames };
}

/** A result.html; returns its address. */
export function writeResultPage(folder: string, name: string, recording: Buffer, report: object): string {
  const page = readFileSync(path.join(webFolder, "dist/page.html"), "utf8");
  const embedded = [
    '<script id="source" type="application/json">{"kind": "embedded"}</script>',
    `<script id="recording" type="text/plain">${recording.toString("base64")}</script>`,
    `<script id="report" type="application/json">${JSON.stringify(report).replaceAll("</", "<\\/")}</script>`,
  ];
  const file = path.join(folder, name);
  writeFileSync(
    file,
    page.replace(SOURCE, () => embedded.join("\n")),
  );
  return `file://${file}`;
}

const bytesOf = (values: Uint32Array | Float32Array | Float64Array) =>
  Buffer.from(values.buffer, values.byteOffset, values.byteLength);

const withLength = (bytes: Uint8Array) => Buffer.concat([bytesOf(Uint32Array.of(bytes.length)), bytes]);

/** CRC-32 of ISO 3309, bit by bit. */
export function crc32(bytes: Uint8Array): number {
  let c = 0xffffffff;
  for (const byte of bytes) {
    c ^= byte;
    for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  }
  return (c ^ 0xffffffff) >>> 0;
}
