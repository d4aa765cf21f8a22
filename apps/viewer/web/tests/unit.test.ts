/** Parts of the page that need no browser. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import * as THREE from "three";
import { nameOfField, readAddress, writeAddress } from "../src/address";
import type { SceneUniforms } from "../src/body_shader";
import { color, viridis } from "../src/color_map";
import { Colliders } from "../src/colliders";
import { sharpEdges, splitAtCreases, uniqueEdges, vertexNormals } from "../src/creases";
import { tableText } from "../src/export_chart";
import { valuesAlong } from "../src/line_probe";
import { readNumber } from "../src/number_slider";
import { modeWords, swingAt } from "../src/modes";
import { fixed, perDepth, plain, roundTicks, scaledUnit, withoutRounding, withUnit } from "../src/numbers";
import { pick } from "../src/picking";
import { decodeFrame, decodeMessage, decodeTopology, encodeMessage, type Frame } from "../src/protocol";
import { curvesOf, timeAxis } from "../src/report";
import { Revolved } from "../src/revolve";
import { cutTetrahedra } from "../src/section";
import { grouped } from "../src/warnings";
import { repository } from "./harness";

/** A box with corners at 0 and 1, two triangles on each side, seen from outside counter-clockwise. */
function box(): { triangles: Uint32Array; places: Float32Array } {
  const places = Float32Array.from([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1]);
  const quads = [0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7];
  const triangles: number[] = [];
  for (let q = 0; q < quads.length; q += 4)
    triangles.push(quads[q], quads[q + 1], quads[q + 2], quads[q], quads[q + 2], quads[q + 3]);
  return { triangles: Uint32Array.from(triangles), places };
}

test("the page has the colours of resilin picture", () => {
  const source = readFileSync(path.join(repository, "src/resilin/picture/color_map.cpp"), "utf8");
  const table = /viridis = \{([\s\S]*?)\};/.exec(source)![1];
  const numbers = [...table.matchAll(/\d+/g)].map(Number);
  assert.deepEqual(viridis.flat(), numbers);
  assert.deepEqual(color(0), viridis[0]);
  assert.deepEqual(color(1), viridis[32]);
});

test("numbers read as people write them", () => {
  assert.equal(withUnit(20000, "Pa"), "20 kPa");
  assert.equal(withUnit(-0.00123, "m"), "\u22121.23 mm");
  assert.equal(withUnit(0, "N"), "0 N");
  assert.deepEqual(scaledUnit(123456, "Pa"), { factor: 1000, name: "kPa" });
  assert.deepEqual(scaledUnit(0.4, "m"), { factor: 0.001, name: "mm" });
  assert.deepEqual(scaledUnit(1.2, ""), { factor: 1, name: "" });
  assert.equal(plain(1234.5), "1235");
  assert.equal(plain(1.5e-6), "1.5e\u22126");
  assert.equal(fixed(NaN, 2), "–");
  assert.equal(readNumber("20 kPa", "Pa"), 20000);
  assert.equal(readNumber("2e4", "Pa"), 20000);
  assert.equal(readNumber("5M", "Pa"), 5e6);
  assert.ok(Number.isNaN(readNumber("soft", "Pa")));
  assert.ok(Number.isNaN(readNumber("20 kN", "Pa")));
});

test("a box has sharp edges and a flat side has none", () => {
  const { triangles, places } = box();
  const corners = splitAtCreases(triangles, places, Math.PI / 4);
  assert.equal(corners.source.length, 24); // four for each of six sides
  assert.equal(splitAtCreases(triangles, places, Math.PI).source.length, 8);
  const drawn = Float32Array.from([...corners.source].flatMap((v) => [...places.subarray(3 * v, 3 * v + 3)]));
  const normals = new Float32Array(drawn.length);
  vertexNormals(corners.triangles, drawn, normals);
  for (let v = 0; v < corners.source.length; ++v) {
    const n = normals.subarray(3 * v, 3 * v + 3);
    assert.equal([...n].filter((x) => Math.abs(x) > 1e-6).length, 1, "a side's normal has one component");
    const outside = [0, 1, 2].reduce((sum, k) => sum + n[k] * (drawn[3 * v + k] - 0.5), 0);
    assert.ok(outside > 0, "normals point outwards");
  }
  assert.equal(uniqueEdges(triangles).length / 2, 18);
});

test("a line of sight meets the first triangle, or the first that is not cut away", () => {
  const { triangles, places } = box();
  const ray = new THREE.Ray(new THREE.Vector3(0.3, 0.2, 5), new THREE.Vector3(0, 0, -1));
  const hit = pick(ray, [{ part: 0, triangles }], places, null)!;
  assert.deepEqual(
    hit.point.toArray().map((x) => Number(x.toFixed(6))),
    [0.3, 0.2, 1],
  );
  assert.equal(hit.vertex, 4);
  const behind = pick(ray, [{ part: 0, triangles }], places, (_x, _y, z) => z > 0.5)!;
  assert.ok(Math.abs(behind.point.z) < 1e-6);
  assert.equal(
    pick(new THREE.Ray(ray.origin, new THREE.Vector3(0, 1, 0)), [{ part: 0, triangles }], places, null),
    null,
  );
});

test("a press on 200,000 triangles is answered within a frame", () => {
  const n = 316;
  const places = new Float32Array(3 * (n + 1) ** 2);
  const triangles = new Uint32Array(6 * n * n);
  for (let j = 0, v = 0; j <= n; ++j) for (let i = 0; i <= n; ++i, v += 3) places.set([i / n, j / n, 0], v);
  for (let j = 0, t = 0; j < n; ++j)
    for (let i = 0; i < n; ++i, t += 6) {
      const a = j * (n + 1) + i;
      triangles.set([a, a + 1, a + n + 2, a, a + n + 2, a + n + 1], t);
    }
  const ray = new THREE.Ray(new THREE.Vector3(0.7, 0.6, 3), new THREE.Vector3(0, 0, -1));
  const times = Array.from({ length: 7 }, () => {
    const start = process.cpuUsage().user;
    assert.ok(pick(ray, [{ part: 0, triangles }], places, null));
    return (process.cpuUsage().user - start) / 1000;
  });
  assert.ok(Math.min(...times) < 16, `${Math.min(...times)} ms`);
});

test("a frame is decoded as docs/view_protocol.md says", () => {
  const buffer = new ArrayBuffer(64 + 12 + 4 + 4);
  const view = new DataView(buffer);
  view.setUint32(0, 0x31465352, true);
  view.setUint32(4, 9, true);
  view.setFloat64(8, 1.5, true);
  view.setUint32(16, 4, true);
  view.setUint32(20, 2, true);
  view.setUint32(24, 3, true);
  view.setUint32(28, 1, true);
  [-1, 0, 2, 4, 2, 0].forEach((value, i) => view.setFloat32(32 + 4 * i, value, true));
  view.setFloat32(56, 10, true);
  view.setFloat32(60, 20, true);
  [0, 65535, 0, 65535, 0, 0].forEach((value, i) => view.setUint16(64 + 2 * i, value, true));
  [127, 0, 0, -127].forEach((value, i) => view.setInt8(76 + i, value));
  [1, 65535].forEach((value, i) => view.setUint16(80 + 2 * i, value, true));
  const frame = decodeFrame(buffer, new Float32Array(6));
  assert.deepEqual([...frame.positions], [-1, 2, 2, 3, 0, 2]);
  assert.deepEqual([frame.number, frame.time, frame.answersDrag, frame.field], [9, 1.5, 4, 1]);
  assert.deepEqual([...frame.normals!, ...frame.fieldValues!], [127, 0, 0, -127, 1, 65535]);
  assert.throws(() => decodeFrame(buffer, new Float32Array(9)), /number of vertices/);
});

test("arrows of a frame are shares of their greatest component", () => {
  const bytes = new DataView(new ArrayBuffer(64 + 8 + 8 + 8));
  bytes.setUint32(0, 0x31465352, true);
  bytes.setUint32(20, 1, true);
  bytes.setUint32(24, 8, true);
  bytes.setUint32(72, 5, true);
  bytes.setFloat32(76, 4, true);
  [32767, 0, -16384].forEach((step, i) => bytes.setInt16(80 + 2 * i, step, true));
  const { arrows, field } = decodeFrame(bytes.buffer, new Float32Array(3));
  assert.equal(field, -1);
  assert.equal(arrows!.field, 5);
  [4, 0, -2].forEach((x, i) => assert.ok(Math.abs(arrows!.vectors[i] - x) < 1e-3));
});

test("colliders follow the bodies in topology and frames", () => {
  const part = { name: "a", body: "a", kind: "cells" as const, first_vertex: 0, num_vertices: 3 };
  const collider = { name: "wing", num_vertices: 2, num_facets: 1, closed: false, endless: false };
  const header = {
    dimension: 2 as const,
    parts: [{ ...part, num_triangles: 1, num_edges: 0 }],
    colliders: [collider],
  };
  const numbers = [0x31545352, 1, 0, 1, 2];
  const places = [0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 6, 0, 7, 8, 0];
  const buffer = new ArrayBuffer(4 * (numbers.length + places.length + 2));
  new Uint32Array(buffer).set(numbers);
  new Float32Array(buffer).set(places, numbers.length);
  new Uint32Array(buffer).set([0, 1], numbers.length + places.length);
  const { colliders, restPositions } = decodeTopology(buffer, header);
  assert.deepEqual([...restPositions], places.slice(0, 9));
  assert.deepEqual([...colliders[0].vertices], places.slice(9));
  assert.deepEqual([...colliders[0].facets], [0, 1]);
  assert.deepEqual(decodeTopology(buffer, { ...header, colliders: undefined }).colliders, []);

  const frame = new ArrayBuffer(64 + 8 + 4 + 48); // one vertex with a field, each padded
  const view = new DataView(frame);
  view.setUint32(0, 0x31465352, true);
  view.setUint32(20, 1, true);
  view.setUint32(24, 2 + 4, true);
  for (let i = 0; i < 12; ++i) view.setFloat32(76 + 4 * i, i, true);
  assert.deepEqual([...decodeFrame(frame, new Float32Array(3)).colliders!], [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]);
});

test("a collider is drawn where its numbers put it, solid where it has an inside", () => {
  const square = {
    vertices: Float32Array.from([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]),
    facets: Uint32Array.from([0, 1, 1, 2, 2, 3, 3, 0]),
  };
  const shape = { name: "", num_vertices: 4, num_facets: 4, endless: false };
  const wall = { vertices: Float32Array.from([0, 0, 0, 1, 0, 0]), facets: Uint32Array.from([0, 1]) };
  const uniforms = {} as SceneUniforms;
  const colliders = new Colliders(
    [
      { ...shape, closed: true },
      { ...shape, num_vertices: 2, num_facets: 1, closed: false, endless: true },
    ],
    [square, wall],
    uniforms,
    true,
  );
  const quarterTurn = [0, -1, 0, 2, 1, 0, 0, 3, 0, 0, 1, 0];
  const still = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
  colliders.move(Float32Array.from([...quarterTurn, ...still]));
  assert.deepEqual(colliders.firstPlaces[0], [2, 3, 0]);
  const box = new THREE.Box3(new THREE.Vector3(0, 2, 0), new THREE.Vector3(1.5, 3, 0));
  colliders.widen(box, 0.25);
  assert.deepEqual(box.min.toArray(), [0, 2, 0]);
  assert.deepEqual(box.max.toArray(), [1.75, 3.25, 0], "no further than it may, and a line without end counts not");
  const meshes = colliders.solids.children.filter((child) => child instanceof THREE.Mesh);
  assert.ok(
    meshes.some(({ geometry }) => geometry.index!.count === 6),
    "the square is filled with two triangles",
  );
});

/** A valid `hello` of a scene with one control of each kind. */
function hello(): Record<string, unknown> {
  const shared = { folder: "Material", help: "What it does" };
  const slider = { ...shared, unit: "Pa", least: 1, greatest: 10 };
  return {
    type: "hello",
    client: 3,
    saves: true,
    title: "Spot",
    version: "0.1.0",
    dimension: 3,
    extent: 1,
    up: [0, 1, 0],
    gravity: [0, -9.81, 0],
    parts: [],
    fields: [{ name: "von_mises", label: "von Mises stress", unit: "Pa" }],
    controls: [
      { kind: "slider", key: "a", label: "A", ...slider, step: 0.1 },
      { kind: "log_slider", key: "b", label: "B", ...slider },
      { kind: "switch", key: "c", label: "C", ...shared, hotkey: "g" },
      { kind: "choice", key: "d", label: "D", ...shared, options: [{ name: "one", label: "One" }] },
      { kind: "arrow", key: "e", label: "E", ...shared, unit: "m", greatest: 1, step: 0.1, initial: [0, 0, 1] },
    ],
    state: {
      type: "state",
      values: { a: 1, b: 2, c: true, d: "one", e: [0, 0, 1] },
      paused: false,
      ground: null,
      pinned: [],
      held: [],
      grabbed_by: null,
      poking: false,
      warnings: [],
    },
  };
}

test("a message of the program has its type, or is refused in a line that says where", () => {
  const read = (message: object) => decodeMessage(JSON.stringify(message));
  const whole = read(hello());
  assert.equal(whole.type, "hello");
  if (whole.type !== "hello") return;
  assert.deepEqual(
    whole.controls.map((control) => control.kind),
    ["slider", "log_slider", "switch", "choice", "arrow"],
  );
  assert.equal(whole.state.values.d, "one");
  assert.equal(whole.eye, undefined);
  assert.throws(() => read({ type: "hallo" }), /message of the program.type: expected one of hello, state, .*"hallo"/);
  assert.throws(() => read([]), /expected an object, got \[\]/);
  assert.throws(() => read({ type: "error" }), /program.message: expected a text, got nothing/);
  assert.throws(() => read({ ...hello(), dimension: 4 }), /dimension: expected one of 2, 3, got 4/);
  assert.throws(() => read({ ...hello(), up: [0, 1] }), /up: expected three numbers/);
  assert.throws(() => read({ ...hello(), controls: [{ kind: "slider" }] }), /controls\[0\].key: expected a text/);
  assert.throws(() => read({ ...hello(), controls: [{ kind: "knob" }] }), /controls\[0\].kind: expected one of slider/);
});

test("a number that the program could not write is not a number", () => {
  const numbers = ["time", "real_time_ratio", "step_ms", "assembly_ms", "solve_ms", "surface_ms", "other_ms"].concat(
    ["newton_iterations", "linear_iterations", "residual", "relative_residual", "min_volume_ratio"],
    ["inverted_cells", "smallest_gap", "active_pairs", "elastic_energy", "kinetic_energy"],
  );
  const status = { type: "status", ...Object.fromEntries(numbers.map((name) => [name, 1])) };
  const flags = { converged: true, at_rest: false, words: "" };
  const read = decodeMessage(JSON.stringify({ ...status, ...flags, residual: Infinity }));
  assert.ok(read.type === "status" && Number.isNaN(read.residual) && read.step_ms === 1);
});

test("drags and acknowledgements are bytes, all else is JSON", () => {
  const bytes = (message: string | ArrayBuffer) => [...new Uint8Array(message as ArrayBuffer)];
  assert.deepEqual(bytes(encodeMessage({ type: "acknowledge", frame: 263 })), [1, 0, 0, 0, 7, 1, 0, 0]);
  const drag = new DataView(encodeMessage({ type: "drag", number: 9, target: { x: 1, y: 2, z: -3 } }) as ArrayBuffer);
  assert.deepEqual([drag.byteLength, drag.getUint32(0, true), drag.getUint32(4, true)], [20, 2, 9]);
  assert.deepEqual(
    [8, 12, 16].map((offset) => drag.getFloat32(offset, true)),
    [1, 2, -3],
  );
  assert.equal(encodeMessage({ type: "set", key: "law", value: "gent" }), '{"type":"set","key":"law","value":"gent"}');
});

test("an address holds the whole view, and what is wrong in it is left out", () => {
  const view = {
    frame: 12,
    from: 0,
    field: "von_mises",
    camera: { azimuth: 0.5, elevation: 0.25, distance: 3, target: [0, 1, -2] as [number, number, number] },
    look: {
      wireframe: true,
      cells: false,
      cut: true,
      cutFlip: false,
      parallel: true,
      arrows: "velocity",
      cutAxis: "y" as const,
      cutAt: 0.3,
      revolve: 270,
    },
    range: [1, 2e5] as [number, number],
  };
  assert.deepEqual(readAddress(writeAddress(view)), view);
  const wrong = readAddress("#frame=-3&from=x&camera=1,2&cut=q9&range=5,1&show=nothing&revolve=7");
  assert.deepEqual(wrong, {
    look: { wireframe: false, cells: false, cut: false, cutFlip: false, parallel: false, arrows: "", revolve: 0 },
  });
});

test("curves come from what the report holds", () => {
  const frames = [0, 1, 2].map((t) => ({
    time: t,
    load: 1,
    energy: { elastic: t, kinetic: 0 },
    reactions: { left: [1, 2, t] },
    probes: {},
  }));
  const curves = curvesOf({ status: "done", frames });
  assert.deepEqual(
    curves.map((c) => c.title),
    ["Energy", "Reaction of “left”"],
  );
  assert.deepEqual(
    curves[0].series.map((s) => s.label),
    ["elastic"],
  );
  assert.deepEqual(curves[1].values[2], [0, 1, 2]);
  assert.equal(timeAxis(frames).label, "time");
  assert.equal(
    timeAxis([
      { time: 0, load: 0.5 },
      { time: 0, load: 1 },
    ]).label,
    "load",
  );
});

test("curves of vibrations are their frequencies, without those of rigid modes", () => {
  const mode = (number: number, frequency: number, rigid: boolean) => ({
    time: 0,
    load: 1,
    mode: { number, frequency, rigid },
  });
  const frames = [{ time: 0, load: 1, newton_iterations: 3 }, mode(1, 0, true), mode(2, 440, false)];
  const [only, ...others] = curvesOf({ status: "done", frames });
  assert.equal(only.title, "Frequency");
  assert.deepEqual(only.values, [[NaN, NaN, 440]]);
  assert.deepEqual(others, []);
  assert.equal(timeAxis(frames).label, "mode");
  const third = { number: 2, frequency: 440, isRigid: false, isUnstable: false };
  assert.equal(modeWords(third, 12), "mode 2 of 12 · 440 Hz");
  assert.equal(modeWords({ ...third, isRigid: true }, 12), "mode 2 of 12 · rigid-body mode");
  assert.deepEqual([swingAt(0), Math.round(swingAt(0.5)), swingAt(1)], [1, -1, 1]);
});

test("a range that is rounding becomes one that is not", () => {
  assert.deepEqual(withoutRounding([0, 5], 1e5), [0, 5]);
  assert.deepEqual(withoutRounding([0, 1e-30], 10), [0, 1e-8]);
  withoutRounding([1, 1 + 1e-12], 1).forEach((end, i) => assert.ok(Math.abs(end - [1 - 5e-7, 1 + 5e-7][i]) < 1e-11));
  const [low, high] = withoutRounding([-1e-20, 1e-20], 1e6);
  assert.ok(low < -4e-4 && high > 4e-4);
});

test("a plane through a tetrahedron meets it in a triangle or a quadrilateral, with the values between", () => {
  const positions = Float32Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]);
  const corners = Uint32Array.from([0, 1, 2, 3]);
  const fieldValues = Uint16Array.from([1, 65535, 1, 1]); // x
  const triangle = cutTetrahedra(corners, { positions, fieldValues }, { x: 1, y: 0, z: 0, w: 0.25 });
  assert.equal(triangle.count, 3);
  for (let i = 0; i < 3; ++i) {
    assert.equal(triangle.places[3 * i], 0.25);
    assert.ok(Math.abs(triangle.values[i] - 0.25) < 1e-4);
  }
  const [x, y] = [1, 1].map((one) => one / Math.SQRT2);
  const quadrilateral = cutTetrahedra(corners, { positions, fieldValues }, { x, y: -y, z: 0.1, w: 0.05 });
  const separate = new Set(
    [...Array(quadrilateral.count).keys()].map((i) => quadrilateral.places.slice(3 * i, 3 * i + 3).join()),
  );
  assert.equal(quadrilateral.count, 6);
  assert.equal(separate.size, 4);
  fieldValues[1] = 0; // not a number
  assert.ok(cutTetrahedra(corners, { positions, fieldValues }, { x: 1, y: 0, z: 0, w: 0.25 }).values.includes(-1));
  assert.equal(cutTetrahedra(corners, { positions, fieldValues }, { x: 1, y: 0, z: 0, w: 2 }).count, 0);
});

test("an old link finds the field by its new name", () => {
  const fields = [{ name: "displacement" }, { name: "averaged_von_mises" }];
  assert.equal(nameOfField(fields, "von_mises"), "averaged_von_mises");
  assert.equal(nameOfField([...fields, { name: "nodal_von_mises" }], "von_mises"), "nodal_von_mises");
  assert.equal(nameOfField(fields, "displacement"), "displacement");
  assert.equal(nameOfField(fields, "pressure"), "");
});

test("warnings that differ in a name and a number alone are one line", () => {
  const text = (name: string, share: string) =>
    `/home/me/a.toml: "${name}" has an estimated error of ${share} %: take finer cells`;
  assert.deepEqual(grouped([text("a", "5.7"), text("b", "23"), "something else"]), [
    'a.toml: "a", "b" have an estimated error of 5.7 to 23 %: take finer cells',
    "something else",
  ]);
});

test("numbers on the bar of colours are round", () => {
  assert.deepEqual(roundTicks(0, 116, 5), [0, 50, 100]);
  assert.deepEqual(roundTicks(-1, 1, 5), [-1, -0.5, 0, 0.5, 1]);
  assert.deepEqual(roundTicks(1, 1, 5), []);
});

test("in 2D forces and energies are those of a metre of depth", () => {
  assert.equal(perDepth("N", 2), "N/m");
  assert.equal(perDepth("N", 3), "N");
  assert.equal(perDepth("Pa", 2), "Pa");
});

test("a line through cells has the values that are linear in each", () => {
  const cells = Uint32Array.of(0, 1, 2, 1, 3, 2);
  const positions = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0);
  const fieldValues = Uint16Array.of(1, 65535, 1, 65535); // x from 0 to 1
  const frame = { positions, fieldValues, least: 0, greatest: 1 } as Frame;
  const { distances, values } = valuesAlong(cells, 3, frame, [-1, 0.25, 0], [2, 0.25, 0]);
  assert.equal(distances.length, 4);
  distances.forEach((d, i) => assert.ok(Math.abs(values[i] - (d - 1)) < 1e-6, `${values[i]} at ${d}`));
});

test("edges are where triangles meet at an angle, and borders", () => {
  const places = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1);
  const { edges, creased } = sharpEdges(Uint32Array.of(0, 1, 2, 1, 0, 3), places, 0.7);
  assert.equal(edges.length, 10);
  assert.ok(creased > 0.1 && creased < 0.5);
  assert.equal(
    tableText(
      ["a", "b,c"],
      [
        [1, 2],
        [3, null],
      ],
    ),
    'a,"b,c"\n1,3\n2,\n',
  );
});

test("a half section is revolved into a closed body of outward triangles", () => {
  // A square from radius 1 to 2, between heights 0 and 1; one more that touches the axis.
  const square = [0, 1, 2, 0, 2, 3];
  const part = { name: "", body: "", kind: "cells" as const, num_vertices: 4, num_triangles: 2, num_edges: 0 };
  const header = {
    title: "",
    version: "",
    dimension: 2 as const,
    extent: 2,
    up: [0, 1, 0] as [number, number, number],
    gravity: [0, 0, 0] as [number, number, number],
    parts: [
      { ...part, first_vertex: 0 },
      { ...part, first_vertex: 4 },
    ],
    fields: [],
    marks: [{ kind: "probe" as const, name: "", vertices: [5] }],
    colliders: [{ name: "", num_vertices: 2, num_facets: 1, closed: false, endless: true }],
  };
  const section = {
    triangles: [Uint32Array.from(square), Uint32Array.from(square, (v) => v + 4)],
    edges: [new Uint32Array(), new Uint32Array()],
    tetrahedra: [new Uint32Array(), new Uint32Array()],
    restPositions: Float32Array.from([1, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0, 1, 3, 0, 0, 3, 0]),
    colliders: [{ vertices: Float32Array.from([-3, 0, 0, 3, 0, 0]), facets: Uint32Array.from([0, 1]) }],
  };
  const place = [1, 0, 0, 0, 0, 1, 0, 4, 0, 0, 1, 0]; // at a height of 4
  for (const angle of [180, 270, 360]) {
    const body = new Revolved(header, section, angle, Float32Array.from(place));
    const share = angle / 360;
    [3 * Math.PI * share, Math.PI * share].forEach((volume, p) => {
      const { triangles, restPositions } = body.topology;
      let [sum, hit] = [0, new Set<string>()];
      for (let i = 0; i < triangles[p].length; i += 3) {
        const corners = [0, 1, 2].map((k) => new THREE.Vector3().fromArray(restPositions, 3 * triangles[p][i + k]));
        sum += corners[0].dot(corners[1].clone().cross(corners[2])) / 6;
        const names = corners.map((corner) =>
          corner
            .toArray()
            .map((x) => x.toFixed(4).replace("-0.0000", "0.0000"))
            .join(),
        );
        for (let k = 0; k < 3; ++k) {
          const back = `${names[(k + 1) % 3]} ${names[k]}`;
          if (!hit.delete(back)) hit.add(`${names[k]} ${names[(k + 1) % 3]}`);
        }
      }
      assert.equal(hit.size, 0, `${angle} degrees, part ${p}: closed`);
      assert.ok(Math.abs(sum / volume - 1) < 2e-3, `${angle} degrees, part ${p}: volume ${sum}, not ${volume}`);
    });
    assert.deepEqual(body.header.marks![0].vertices, [body.copyOf(5)]);
    assert.equal(body.source[body.copyOf(5)], 5);
    const moved = place.map((value, i) => (i === 7 ? 5 : i === 3 ? 0.75 : value));
    const values = new Uint16Array(8).map((_, v) => v + 1);
    const vectors = Float32Array.from(section.restPositions); // outward and up
    const frame = body.frame({
      number: 0,
      time: 0,
      answersDrag: 0,
      field: 0,
      least: 0,
      greatest: 1,
      positions: section.restPositions,
      normals: null,
      fieldValues: values,
      colliders: Float32Array.from(moved),
      arrows: { field: 0, greatest: 1, vectors },
    } as Frame);
    assert.deepEqual(frame.arrows!.vectors, frame.positions, "vectors turn with the section");
    body.source.forEach((from, v) => assert.equal(frame.fieldValues![v], from + 1));
    assert.equal(frame.colliders![7], 1, "it has moved by 1");
    assert.ok(Math.abs(frame.colliders![0] - 1.5) < 1e-6, "outward by half of its mean radius of 1.5");
    const [collider] = body.topology.colliders;
    assert.ok(collider.vertices.every((value, i) => i % 3 !== 1 || value === 4));
    assert.ok(collider.vertices.every((value) => Math.abs(value) <= 4));
  }
});
