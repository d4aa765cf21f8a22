/** Pages on a live scene, for the tests. */

import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import path from "node:path";
import { setTimeout } from "node:timers/promises";
import { repository, webFolder, type TestBrowser, type Watched } from "./harness";

export const jelly = path.join(webFolder, "tests/scenes/jelly.toml");
export const strip = path.join(webFolder, "tests/scenes/strip.toml");

/** The solver in WebAssembly, and why a test without it is skipped. */
export const module = path.join(repository, "build/wasm/apps/play/resilin_play.wasm");
export const withoutModule = existsSync(module) ? false : "no module: scripts/build_wasm.sh builds it";

/** Opens a page, waits for the scene, works with it, and asks that nothing went wrong in it. */
export async function withPage(
  browser: TestBrowser,
  address: string,
  work: (page: Watched) => Promise<void>,
  options: Parameters<TestBrowser["open"]>[1] = {},
): Promise<void> {
  const watched = await browser.open(address, options);
  try {
    await watched.firstFrame();
    await watched.until("resilin.state");
    await work(watched);
    assert.deepEqual(watched.faults, []);
    assert.deepEqual(await watched.value("resilin.errors"), []);
  } finally {
    await watched.close();
  }
}

export interface Grip {
  vertex: number;
  x: number; // in the window [pixels]
  y: number;
}

/** A page that answers: a window's, or that in a frame. */
interface Answering {
  value<T>(expression: string): Promise<T>;
}

/**
 * A place of the body that is seen near the middle of what the panel leaves free, once the body stands still there: it
 * may swing from what was done to it before, and a place of this frame may be off the body in the next.
 */
export async function grip(page: Answering): Promise<Grip> {
  const seen = `(() => {
    const middle = resilin.middleOfBody();
    const [x, y] = [Math.round(middle.x), Math.round(middle.y)];
    const vertex = resilin.pickAt(x, y)?.vertex ?? null;
    return vertex === null ? null : { grip: { vertex, x, y }, at: resilin.seenAt(vertex) };
  })()`;
  const isStill = ({ grip: { vertex, x, y }, at }: Seen) => `(() => {
    const { x, y } = resilin.seenAt(${vertex});
    return Math.hypot(x - ${at.x}, y - ${at.y}) < 1 && resilin.pickAt(${x}, ${y}) !== null;
  })()`;
  for (const end = Date.now() + 60_000; Date.now() < end;) {
    const found = await page.value<Seen | null>(seen);
    await setTimeout(200);
    if (found && (await page.value<boolean>(isStill(found)))) return found.grip;
  }
  throw new Error("no body stands still in the middle of the window");
}

interface Seen {
  grip: Grip;
  at: { x: number; y: number }; // where its vertex is seen [pixels]
}

export type Vector = [number, number, number];

export const position = (watched: Watched, vertex: number) => watched.value<Vector>(`resilin.position(${vertex})`);

export const distance = (a: number[], b: number[]) => Math.hypot(...a.map((x, i) => x - b[i]));

/** How far the vertex is from `place`, as an expression for `Watched.until`. */
export const distanceFrom = (vertex: number, place: number[]) =>
  `Math.hypot(...resilin.position(${vertex}).map((x, i) => x - ${JSON.stringify(place)}[i]))`;

/** Puts the scene back to its start and waits until the page has seen it. */
export async function reset(watched: Watched): Promise<void> {
  await watched.until("resilin.time > 0");
  const restarts = await watched.value<number>("resilin.restarts");
  await watched.value("resilin.send({ type: 'reset' })");
  await watched.until(`resilin.restarts > ${restarts}`);
}
