/** Reading recordings, whole and damaged. */

import assert from "node:assert/strict";
import { test } from "node:test";

import { decodeFieldFrames, RecordedValues } from "../src/recorded_values";
import { readRecording } from "../src/recording";

import { bendingBeam, crc32, QUANTUM, writeRecording } from "./recording_writer";

const beam = bendingBeam(5, 0.3);
const recording = writeRecording(beam);
const buffer = (bytes: Buffer) => new Uint8Array(bytes).buffer;
const read = (bytes: Buffer) => readRecording(buffer(bytes), () => {});

test("the check sum is that of the standard", () => {
  assert.equal(crc32(Buffer.from("123456789")), 0xcbf43926);
});

test("places and fields of a recording come back within their quanta", async () => {
  const values = new RecordedValues(await read(recording));
  assert.equal(values.recording.frames.length, 5);
  assert.equal(values.recording.damage, "");
  beam.frames.forEach((expected, f) => {
    const frame = values.frame(f, 1);
    // Half a quantum, and the rounding of 32-bit places.
    frame.positions.forEach((x, i) => assert.ok(Math.abs(x - expected.places[i]) < 0.51 * QUANTUM + 1e-7));
    expected.field.forEach((value, v) =>
      assert.ok(Math.abs(values.value(f, 1, v) - value) <= 1e4 / 4094 + 1e-6 * value),
    );
    assert.ok(Math.abs(frame.time - 0.1 * f) < 1e-12);
  });
  const tip = beam.rest.length / 3 - 1;
  assert.ok(Math.abs(values.displacement(4, tip)[1] + 0.3) < 2 * QUANTUM);
  assert.deepEqual(values.displacement(0, tip), [0, 0, 0, 0]);
  assert.ok(Math.abs(values.range(0)[1] - 0.3) < 2 * QUANTUM);
  assert.ok(Math.abs(values.range(1)[1] - 1e4) < 1);
});

test("a recording that is cut off or damaged gives the frames before it", async () => {
  assert.equal((await read(recording.subarray(0, recording.length - 3))).frames.length, 4);
  const flipped = Buffer.from(recording);
  flipped[recording.length - 20] ^= 1;
  const damaged = await read(flipped);
  assert.equal(damaged.frames.length, 4);
  assert.match(damaged.damage, /damaged after 4 frames/);
});

test("what is not a recording is refused in words", async () => {
  await assert.rejects(read(Buffer.from("something else altogether")), /does not begin with RSR1/);
  await assert.rejects(read(recording.subarray(0, 40)), /ends inside its header/);
  await assert.rejects(read(recording.subarray(0, 900)), /ends inside its topology/);
});

/**
 * The bytes of a field that the program computes: value v at vertex v of every frame, in frames of these
 * numbers.
 */
function fieldBytes(numVertices: number, numbers: number[]): ArrayBuffer {
  const size = 12 + 2 * (numVertices + (numVertices % 2));
  const view = new DataView(new ArrayBuffer(12 + size * numbers.length));
  [0x31565352, numVertices, numbers.length].forEach((word, i) => view.setUint32(4 * i, word, true));
  numbers.forEach((number, f) => {
    const offset = 12 + f * size;
    view.setUint32(offset, number, true);
    view.setFloat32(offset + 4, 0, true);
    view.setFloat32(offset + 8, 65534, true);
    for (let v = 1; v < numVertices; ++v) view.setUint16(offset + 12 + 2 * v, v + 1, true); // vertex 0: not a number
  });
  return view.buffer;
}

test("a field that is not recorded is fetched once, and belongs to the frames by their numbers", async () => {
  const numVertices = beam.rest.length / 3;
  const asked: string[] = [];
  const values = new RecordedValues(await read(recording), {
    fields: ["von_mises", "displacement.x", "pressure"].map((name) => ({ name, label: name, unit: "" })),
    fetch: async (name) => {
      asked.push(name);
      return fieldBytes(numVertices, [4, 3, 1, 0]);
    },
  });
  const names = values.fields.map((field) => field.name);
  assert.equal(new Set(names).size, names.length, "each once");
  const pressure = names.indexOf("pressure");
  assert.ok(names.every((_, i) => values.isReady(i) === (i !== pressure)));
  await values.load(pressure);
  await values.load(pressure);
  await values.load(names.indexOf("von_mises"));
  assert.deepEqual(asked, ["pressure"]);
  for (const frame of [0, 1, 3, 4]) {
    assert.ok(Number.isNaN(values.value(frame, pressure, 0)));
    assert.equal(values.value(frame, pressure, 7), 7);
  }
  assert.ok(Number.isNaN(values.value(2, pressure, 7)), "a frame that was not there");
  assert.deepEqual(values.range(pressure), [0, 65534]);
  assert.equal(values.frame(4, pressure).fieldValues![7], 8);
});

test("components of the displacement are formed from the places", async () => {
  const values = new RecordedValues(await read(recording));
  const y = values.fields.findIndex((field) => field.name === "displacement.y");
  const tip = beam.rest.length / 3 - 1;
  assert.ok(Math.abs(values.value(4, y, tip) + 0.3) < 2 * QUANTUM + 0.3 / 65534);
  assert.ok(Math.abs(values.range(y)[0] + 0.3) < 2 * QUANTUM);
  assert.ok(Math.abs(values.range(y)[1]) < 2 * QUANTUM);
  assert.ok(Math.abs(values.value(4, 0, tip) - 0.3) < 2 * QUANTUM + 0.3 / 65534);
});

test("results open on the frame where most happens, and shapes swing about the first frame", async () => {
  const away = bendingBeam(5, 0.3);
  const [first, , , , last] = away.frames;
  const back = {
    ...away,
    frames: [first, ...away.frames.slice(1, 4), { ...last, places: first.places, field: first.field }],
  };
  const values = new RecordedValues(await read(writeRecording(back)));
  assert.equal(values.mostTelling(1), 3, "not the last, where it is at rest again");
  assert.equal(values.mostTelling(0), 3);
  const tip = beam.rest.length - 2; // y of the last vertex
  const whole = values.frame(3, 0).positions[tip] - beam.rest[tip];
  assert.ok(Math.abs(values.frame(3, 0, -1).positions[tip] - beam.rest[tip] + whole) < 1e-6);
  assert.ok(Math.abs(values.frame(3, 0, 0).positions[tip] - beam.rest[tip]) < 1e-6);
});

test("values of another surface are refused", async () => {
  const { frames } = await read(recording);
  assert.throws(() => decodeFieldFrames(fieldBytes(3, [0]), frames, 4), /another surface/);
  assert.throws(() => decodeFieldFrames(new ArrayBuffer(4), frames, 4), /do not begin with RSV1/);
});
