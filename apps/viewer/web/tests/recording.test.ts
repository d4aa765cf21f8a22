/** Reading recordings, whole and damaged. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { readRecording, RecordedValues } from "../src/recording";
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
