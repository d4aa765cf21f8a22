/** A recording that carries its solver: every frame can be taken up by hand, in node and in a real browser. */

import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { inflateSync } from "node:zlib";
import { Engine } from "../src/engine";
import {
  decodeFrame,
  decodeTopology,
  encodeMessage,
  type Frame,
  type Hello,
  isFrame,
  vertexCount,
} from "../src/protocol";
import { RecordedValues } from "../src/recorded_values";
import { readRecording, type Recording } from "../src/recording";
import { runProgram, TestBrowser, type Watched, webFolder } from "./harness";
import { distance, grip, jelly, module, position, strip, withoutModule } from "./live_pages";

const options = { skip: withoutModule };
const sceneOf = (name: string) => path.join(webFolder, `tests/scenes/${name}.toml`);

let scratch: string;
let browser: TestBrowser | null = null;

before(async () => {
  scratch = mkdtempSync(path.join(os.tmpdir(), "resilin-taking-up-"));
  if (!withoutModule) browser = await TestBrowser.start();
});

after(async () => {
  await browser?.stop();
  rmSync(scratch, { recursive: true, force: true });
});

/** The page of a run; where it is. */
function exported(scene: string, ...settings: string[]): string {
  const out = mkdtempSync(path.join(scratch, "run-"));
  const set = settings.flatMap((setting) => ["--set", setting]);
  runProgram("run", scene, "--out", out, "--formats", "vtu,html", "--quiet", "--set", "output.every=1", ...set);
  runProgram("export", out, `${out}.html`, "--engine", module);
  return `${out}.html`;
}

function bytesIn(page: string, id: string): Buffer {
  const text = new RegExp(`<script id="${id}" type="text/plain">([^<]*)</script>`).exec(page);
  return Buffer.from(text![1], "base64");
}

const carried = (page: string, id: string) => new Uint8Array(inflateSync(bytesIn(page, id)));

async function recordingIn(page: string): Promise<RecordedValues> {
  const bytes = new Uint8Array(bytesIn(page, "recording"));
  return new RecordedValues(await readRecording(bytes.buffer, () => {}));
}

/** A scene in the module, a message at a time. */
class Played {
  private hello: Hello | null = null;
  private positions = new Float32Array(0);
  shown: Frame | null = null;

  constructor(private readonly engine: Engine) {
    this.say({ type: "pause" });
  }

  say(message: Parameters<typeof encodeMessage>[0]): void {
    this.engine.receive(encodeMessage(message));
    this.engine.turn();
    for (let said = this.engine.next(); said !== null; said = this.engine.next())
      if (typeof said === "string") this.hear(said);
      else if (isFrame(said)) {
        this.shown = { ...decodeFrame(said, this.positions), positions: this.positions.slice() };
        this.engine.receive(encodeMessage({ type: "acknowledge", frame: this.shown.number }));
      } else decodeTopology(said, this.hello!);
  }

  private hear(text: string): void {
    const message = JSON.parse(text) as Hello | { type: "error"; message: string };
    assert.notEqual(message.type, "error", text);
    if (message.type !== "hello") return;
    this.hello = message;
    this.positions = new Float32Array(3 * vertexCount(message.parts));
  }
}

function farthest(a: Float32Array, b: Float32Array): number {
  let worst = 0;
  for (let i = 0; i < a.length; ++i) worst = Math.max(worst, Math.abs(a[i] - b[i]));
  return worst;
}

const SCENES: [string, string, string[]][] = [
  ["a block", jelly, ["simulation.end_time=0.4"]],
  ["in 2D", strip, ["simulation.end_time=0.4"]],
  ["bodies that rub on each other and on the ground, and a paddle", sceneOf("pushed"), []],
];

for (const [what, scene, settings] of SCENES)
  test(`${what}: the first step by hand leads to the next frame of the run`, options, async (context) => {
    const page = readFileSync(exported(scene, ...settings), "utf8");
    const values = await recordingIn(page);
    const { frames, header } = values.recording as Recording;
    const module = carried(page, "engine") as BufferSource;
    for (const index of [0, Math.floor(frames.length / 2), frames.length - 2]) {
      const [now, next] = [index, index + 1].map((i) => values.frame(i, -1).positions.slice());
      const engine = await Engine.load(module);
      engine.open(carried(page, "scene"), [], carried(page, `state-${frames[index].number}`));
      const played = new Played(engine);
      const places = 3e-5 * header.extent; // resolution of frames and recordings
      assert.ok(farthest(played.shown!.positions, now) < places);
      assert.equal(played.shown!.time, frames[index].time);
      played.say({ type: "step" });
      const moved = farthest(now, next);
      const error = farthest(played.shown!.positions, next);
      assert.ok(moved > 10 * places, `moved by ${moved} only`);
      assert.ok(error < places + 1e-3 * moved, `frame ${index}: ${error} off, where ${moved} is moved`);
      assert.ok(Math.abs(played.shown!.time - frames[index + 1].time) < 1e-12);
      const colliders = played.shown!.colliders ?? new Float32Array(0);
      assert.ok(farthest(colliders, frames[index + 1].colliders) < 1e-6);
      context.diagnostic(`frame ${index}: ${(error / moved).toExponential(1)} of what is moved`);
    }
  });

test("what stood at half of its load stands so by hand", options, async (context) => {
  const page = readFileSync(exported(sceneOf("tower")), "utf8");
  const values = await recordingIn(page);
  const engine = await Engine.load(carried(page, "engine") as BufferSource);
  assert.equal(values.recording.frames[1].load, 0.5);
  engine.open(carried(page, "scene"), [], carried(page, "state-1"));
  const played = new Played(engine);
  for (let step = 0; step < 30; ++step) played.say({ type: "step" });
  const half = values.frame(1, -1).positions.slice();
  const moved = farthest(values.frame(0, -1).positions.slice(), half);
  context.diagnostic(`${farthest(played.shown!.positions, half) / moved} of what had moved`);
  // Weights of quadratic cells are lumped in motion; under its whole load it would move by as much again.
  assert.ok(farthest(played.shown!.positions, half) < 1e-2 * moved);
});

// In the browser.

async function seek(watched: Watched, frame: number): Promise<void> {
  await watched.page.getByTestId("timeline").fill(String(frame));
  await watched.until(`resilin.frame === ${frame}`);
}

/** Does what lets the page begin anew, and waits until it has. */
async function anew(watched: Watched, work: () => Promise<unknown>): Promise<void> {
  const begun = watched.page.waitForEvent("load");
  await work();
  await begun;
}

/** By the browser's way back, once the address is at rest: one that changes meanwhile lets the browser forget the way. */
async function goBack(watched: Watched): Promise<void> {
  const { page } = watched;
  for (let before = ""; before !== page.url();) {
    before = page.url();
    await page.waitForTimeout(1000);
  }
  await anew(watched, () => page.evaluate("void setTimeout(() => history.back())"));
}

const press = (watched: Watched, button: string) => anew(watched, () => watched.page.getByTestId(button).click());

async function takeUp(watched: Watched): Promise<void> {
  await press(watched, "button-hand");
  await watched.until("resilin && resilin.kind === 'live' && resilin.framesDrawn > 0 && resilin.state");
}

async function withPage(address: string, work: (watched: Watched) => Promise<void>, size = {}): Promise<void> {
  const watched = await browser!.open(address, size);
  try {
    await watched.firstFrame();
    await work(watched);
    assert.deepEqual(watched.faults, []);
    assert.deepEqual(await watched.value("resilin.errors"), []);
    assert.deepEqual(watched.requestsBeyond("file:"), []);
  } finally {
    await watched.close();
  }
}

test(
  "by the mouse, from disk: a frame is sought, taken up, pulled, and left for the recording again",
  options,
  async () => {
    const file = exported(jelly, "simulation.end_time=1");
    const values = await recordingIn(readFileSync(file, "utf8"));
    const { frames } = values.recording;
    await withPage(pathToFileURL(file).href, async (watched) => {
      const { page } = watched;
      const vertex = values.frame(0, -1).positions.length / 3 - 1;
      await seek(watched, 20);
      await takeUp(watched);
      await page.keyboard.press(" ");
      await watched.until("resilin.state.paused");
      assert.match(await page.locator(".subtitle").innerText(), /continued from frame 20, 0\.333 s/);
      // However long it took to pause: a reset leads back to the frame, and a single step to the next one.
      const at = (index: number) => [...values.frame(index, -1).positions.subarray(3 * vertex, 3 * vertex + 3)];
      for (const [key, index] of Object.entries({ r: 20, s: 21 })) {
        await page.keyboard.press(key);
        await watched.until(`Math.abs(resilin.time - ${frames[index].time}) < 1e-9`);
        const place = await position(watched, vertex);
        assert.ok(distance(place, at(index)) < 1e-4, `${place} in place of ${at(index)}`);
      }
      assert.ok(distance(at(20), at(21)) > 1e-3);

      await page.keyboard.press(" ");
      const { x, y } = await grip(watched);
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 60, y - 20, { steps: 5 });
      await watched.until("resilin.status && resilin.status.hand_force > 1");
      await page.mouse.up();
      await watched.until("resilin.state.grabbed_by === null");
      const restarts = await watched.value<number>("resilin.restarts");
      await page.keyboard.press("r");
      await watched.until(`resilin.restarts > ${restarts} && resilin.time >= ${frames[20].time}`);

      await press(watched, "button-back");
      await watched.until("resilin && resilin.kind === 'recorded' && resilin.frame === 20");
      await goBack(watched);
      await watched.until("resilin && resilin.kind === 'live' && resilin.framesDrawn > 0");
      await goBack(watched);
      await watched.until("resilin && resilin.kind === 'recorded' && resilin.frame === 20");
    });
  },
);

test("on a telephone the buttons are there, and a finger takes the frame up and pulls", options, async () => {
  const address = pathToFileURL(exported(jelly, "simulation.end_time=0.3")).href;
  const size = { viewport: { width: 390, height: 780 }, deviceScaleFactor: 1, hasTouch: true, isMobile: true };
  await withPage(
    address,
    async (watched) => {
      const { page } = watched;
      const isSeen = async (button: string) => {
        const box = (await page.getByTestId(button).boundingBox())!;
        assert.ok(
          box.x >= 0 && box.x + box.width <= 390 && box.y + box.height <= 780,
          `${button}: ${JSON.stringify(box)}`,
        );
      };
      await seek(watched, 5);
      for (const button of ["button-play", "button-hand", "button-link"]) await isSeen(button);
      await anew(watched, () => page.getByTestId("button-hand").tap());
      await watched.until("resilin && resilin.kind === 'live' && resilin.framesDrawn > 0 && resilin.state");
      for (const button of ["button-hand", "button-back", "button-help"]) await isSeen(button);
      const { x, y } = await grip(watched);
      const touch = await watched.touch();
      await touch("touchStart", [{ x, y }]);
      await touch("touchMove", [{ x: x + 40, y: y - 20 }]);
      await watched.until("resilin.status && resilin.status.hand_force > 1");
      await touch("touchEnd", []);
      await watched.until("resilin.state.grabbed_by === null");
      assert.equal(await watched.value("document.documentElement.scrollWidth <= innerWidth"), true);
    },
    size,
  );
});

test("addresses of frames are links; what is damaged or not there is said in words", options, async () => {
  const file = exported(jelly, "simulation.end_time=0.1");
  const address = pathToFileURL(file).href;
  await withPage(`${address}#from=3`, async (watched) => {
    assert.equal(await watched.value("resilin.kind"), "live");
    assert.match(await watched.page.locator(".subtitle").innerText(), /continued from frame 3, 0\.05 s/);
  });
  await withPage(`${address}#from=99`, async (watched) =>
    assert.equal(await watched.value("resilin.kind"), "recorded"),
  );
  const page = readFileSync(file, "utf8");
  const damaged = page.replace(/(<script id="state-3" type="text\/plain">.{2000}).{40}/, `$1${"A".repeat(40)}`);
  assert.notEqual(damaged, page);
  writeFileSync(file, damaged);
  const watched = await browser!.open(`${address}#from=3`);
  const words = watched.page.getByText(/The scene cannot be simulated/);
  await words.waitFor({ state: "visible" });
  await watched.close();
});
