/** Pages on a live scene, for the tests. */

import assert from "node:assert/strict";
import path from "node:path";
import { webFolder, type TestBrowser, type Watched } from "./harness";

export const jelly = path.join(webFolder, "tests/scenes/jelly.toml");
export const strip = path.join(webFolder, "tests/scenes/strip.toml");

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

/** A place of the body that is seen near the middle of what the panel leaves free. */
export async function grip(watched: Watched): Promise<Grip> {
  const middle = await watched.value<{ x: number; y: number }>("resilin.middleOfBody()");
  const [x, y] = [Math.round(middle.x), Math.round(middle.y)];
  const vertex = await watched.value<number | null>(`resilin.pickAt(${x}, ${y})?.vertex ?? null`);
  if (vertex !== null) return { vertex, x, y };
  throw new Error("the body is not in the middle of the window");
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
