/** A page that carries its scene: the solver in WebAssembly, in node and in a real browser, beside the program. */

import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, test, type TestContext } from "node:test";
import { pathToFileURL } from "node:url";
import { inflateSync } from "node:zlib";
import { Engine } from "../src/engine";
import { Program, repository, runProgram, TestBrowser, type Watched } from "./harness";
import { grip, jelly, module, position, withoutModule, withPage } from "./live_pages";

const options = { skip: withoutModule };

let scratch: string;
let browser: TestBrowser | null = null;

before(async () => {
  scratch = mkdtempSync(path.join(os.tmpdir(), "resilin-play-"));
  if (!withoutModule) browser = await TestBrowser.start();
});

after(async () => {
  await browser?.stop();
  rmSync(scratch, { recursive: true, force: true });
});

/** The page of a scene; where it is. */
function exported(scene: string, ...more: string[]): string {
  const page = path.join(scratch, `${path.basename(scene, ".toml")}.html`);
  runProgram("export", scene, page, "--engine", module, ...more);
  return page;
}

/** Data that a page carries under this name. */
function carried(page: string, id: string): Uint8Array {
  const text = new RegExp(`<script id="${id}" type="text/plain">([^<]*)</script>`).exec(readFileSync(page, "utf8"));
  return new Uint8Array(inflateSync(Buffer.from(text![1], "base64")));
}

// Validation rows.

type Value = string | number | boolean | Value[] | { [key: string]: Value };

function toml(value: Value): string {
  if (Array.isArray(value)) return `[${value.map(toml).join(", ")}]`;
  if (typeof value !== "object") return JSON.stringify(value);
  return `{ ${Object.entries(value)
    .map(([key, entry]) => `${key} = ${toml(entry)}`)
    .join(", ")} }`;
}

interface Row {
  name: string;
  scene?: string;
  set?: Record<string, Value>;
}

function arguments_of(row: Row): string[] {
  return Object.entries(row.set ?? {}).flatMap(([key, value]) => ["--set", `${key}=${toml(value)}`]);
}

/** Where the nodes are in a frame that the program has written [m]; three numbers each. */
function positionsOfFrame(file: string): Float64Array {
  const data = readFileSync(file);
  const mark = '<AppendedData encoding="raw">\n_';
  const begin = data.indexOf(mark);
  const offset = /Name="Points" [^>]*offset="(\d+)"/.exec(data.subarray(0, begin).toString("latin1"))![1];
  const start = begin + mark.length + Number(offset);
  const bytes = data.subarray(start + 8, start + 8 + Number(data.readBigUInt64LE(start)));
  return new Float64Array(Uint8Array.from(bytes).buffer);
}

function lastFrame(folder: string): string {
  const report = JSON.parse(readFileSync(path.join(folder, "report.json"), "utf8")) as { frames: { step: number }[] };
  const step = String(report.frames.at(-1)!.step).padStart(4, "0");
  return path.join(folder, "frames", `${step}.vtu`);
}

const ROWS: [string, string, number][] = [
  ["patch_test", "neo_hookean, 3D, P1", 3],
  ["patch_test", "mooney_rivlin, 3D, Q1P0", 3],
  ["cook_2d", "neo_hookean, P2 exact, 4 x 4", 2],
  ["cook_3d", "P2P0, 2 x 2 x 2", 3],
  ["twist_bar_3d", "stable_neo_hookean, P1, 2 x 2 x 10", 3],
  ["cantilever_gravity_3d", "neo_hookean, nu = 0.3, P1, 10 x 2 x 2", 3],
  ["hanging_bar", "neo_hookean, P2, 16 cells", 3],
  ["column_bending_dynamics_3d", "newmark, consistent mass, dt = 0.01", 3],
];

for (const [name, wanted, dimension] of ROWS) {
  test(`validation, ${name}: ${wanted}: the module gives the places of the program`, options, async () => {
    const folder = path.join(repository, "validation", name);
    const { rows } = JSON.parse(readFileSync(path.join(folder, "expected.json"), "utf8")) as { rows: Row[] };
    const row = rows.find((entry) => entry.name === wanted)!;
    const scene = path.join(folder, row.scene ?? "scene.toml");
    const out = mkdtempSync(path.join(scratch, "row-"));
    runProgram("run", scene, "--out", out, "--quiet", "--threads", "1", ...arguments_of(row));
    const expected = positionsOfFrame(lastFrame(out));
    const page = exported(scene, ...arguments_of(row));
    const engine = await Engine.load(carried(page, "engine") as BufferSource);
    const places = engine.run(carried(page, "scene"));
    assert.equal(places.length / dimension, expected.length / 3);
    let [least, greatest, worst] = [Infinity, -Infinity, 0];
    for (const x of expected) [least, greatest] = [Math.min(least, x), Math.max(greatest, x)];
    for (let i = 0; i < places.length; ++i) {
      const error = Math.abs(places[i] - expected[3 * Math.floor(i / dimension) + (i % dimension)]);
      assert.ok(!Number.isNaN(error));
      worst = Math.max(worst, error);
    }
    console.log(`# ${name}, ${wanted}: ${(worst / (greatest - least)).toExponential(1)} of the extent`);
    assert.ok(worst <= 1e-12 * (greatest - least), `differs by ${worst / (greatest - least)} of the extent`);
  });
}

// In the browser.

/** Pulls with the mouse until all is at rest; where the vertex under the pointer then is, and what the strip says. */
async function pulled(watched: Watched): Promise<{ vertex: number; place: number[]; status: Record<string, number> }> {
  const { page } = watched;
  await watched.until("resilin.status && resilin.status.at_rest", 120_000); // both begin at one place
  const { vertex, x, y } = await grip(watched);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 90, y - 30, { steps: 6 });
  await watched.until("resilin.state.grabbed_by === resilin.header.client");
  // The frame that answers the last drag, and rest after it: not that of a moment before.
  await watched.until("resilin.connection.answeredDrag === resilin.connection.dragNumber", 120_000);
  await page.waitForTimeout(1000);
  await watched.until("resilin.status.at_rest && resilin.status.hand_force > 0", 120_000);
  const place = await position(watched, vertex);
  const status = await watched.value<Record<string, number>>("resilin.status");
  await page.mouse.up();
  await watched.until("resilin.state.grabbed_by === null");
  return { vertex, place, status };
}

/** The same place of the eye for both pages, which frame what has moved by the time they are ready. */
const EYE = "#camera=0.55,0.28,3,0.5,0.45,0.5";

test("a body is pulled by the mouse from disk, without a request, to where the program has it", options, async () => {
  const address = pathToFileURL(exported(jelly)).href;
  const program = await Program.start(jelly, "--port", "0");
  try {
    let played!: Awaited<ReturnType<typeof pulled>>, served!: Awaited<ReturnType<typeof pulled>>;
    await withPage(browser!, address + EYE, async (watched) => {
      played = await pulled(watched);
      assert.deepEqual(watched.requestsBeyond("file:"), []);
    });
    await withPage(browser!, program.address + EYE, async (watched) => void (served = await pulled(watched)));
    assert.equal(played.vertex, served.vertex);
    assert.ok(played.status.hand_force > 1, `pulled with ${played.status.hand_force} N`);
    for (const key of ["hand_force", "elastic_energy", "min_volume_ratio"])
      assert.ok(
        Math.abs(played.status[key] - served.status[key]) <= 1e-5 * Math.abs(served.status[key]),
        `${key}: ${played.status[key]} in the page, ${served.status[key]} by the program`,
      );
    // Places are sent in steps of 1/65535 of the box that holds them.
    for (let i = 0; i < 3; ++i) assert.ok(Math.abs(played.place[i] - served.place[i]) < 1e-4);
  } finally {
    await program.stop();
  }
});

test("what the page may not do is refused in one line, and reading the scene again begins anew", options, async () => {
  const watched = await browser!.open(pathToFileURL(exported(jelly)).href);
  await watched.firstFrame();
  await watched.value("resilin.send({ type: 'set', key: 'youngs_modulus', value: -1 })");
  const toast = watched.page.getByTestId("toast");
  await toast.waitFor({ state: "visible" });
  assert.match(await toast.innerText(), /youngs_modulus/);
  await watched.until("resilin.time > 0.2");
  const restarts = await watched.value<number>("resilin.restarts");
  await watched.value("resilin.send({ type: 'reload' })");
  await watched.until(`resilin.restarts > ${restarts}`);
  assert.deepEqual(watched.faults, []);
  await watched.close();
});

test("a scene that is damaged is refused in words", options, async (context: TestContext) => {
  const page = exported(jelly);
  const engine = await Engine.load(carried(page, "engine") as BufferSource);
  const scene = carried(page, "scene");
  for (const length of [0, 1, 16, scene.length - 1])
    assert.throws(() => engine.open(scene.slice(0, length), []), /the scene of this page/, `${length} bytes`);
  for (let place = 0; place < scene.length; place += Math.ceil(scene.length / 40)) {
    const damaged = scene.slice();
    damaged[place] ^= 0x40;
    assert.throws(() => engine.open(damaged, []), /the scene of this page/, `byte ${place}`);
  }
  context.diagnostic(`${scene.length} bytes of scene`);
});
