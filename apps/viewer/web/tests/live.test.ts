/** The page of a live scene in a real browser, with the real program behind it. */

import assert from "node:assert/strict";
import path from "node:path";
import { after, before, test } from "node:test";
import { difference, Program, repository, TestBrowser, webFolder } from "./harness";
import { distance, distanceFrom, grip, jelly, position, reset, strip, withPage } from "./live_pages";

let browser: TestBrowser;
let program: Program;

before(async () => {
  browser = await TestBrowser.start();
  program = await Program.start(jelly, "--port", "0");
});

after(async () => {
  await browser?.stop();
  await program?.stop();
});

test("the page shows the body, asks nothing of other hosts and has no errors", async () => {
  await withPage(browser, program.address, async (watched) => {
    const picture = await watched.picture();
    assert.ok(picture.covered > 0.04 && picture.covered < 0.9, `covered: ${picture.covered}`);
    assert.ok(picture.colors > 4, `shading gives several colours, not ${picture.colors}`);
    const { origin } = new URL(program.address);
    assert.deepEqual(
      watched.requests.filter((url) => !url.startsWith(origin) && !url.startsWith("data:")),
      [],
    );
    await watched.until("resilin.status");
    assert.match(await watched.page.getByTestId("real_time_ratio").innerText(), /^(\d+\.\d\d×|at rest)$/);
    assert.match(await watched.page.getByTestId("step_ms").innerText(), /^\d+\.\d\d ms/);
    assert.match(await watched.page.getByTestId("residual").innerText(), /^\d\.\de.\d+ N \(.* %\)$/);
  });
});

test("a page with a wrong token or none is refused", async () => {
  for (const address of [program.address.replace(/token=\w+/, "token=wrong"), new URL("/", program.address).href]) {
    const watched = await browser.open("about:blank");
    const answer = await watched.page.goto(address);
    assert.equal(answer!.status(), 403);
    await watched.close();
  }
});

test("a drag moves the body towards the pointer, and the body swings back after it", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    const { vertex, x, y } = await grip(watched);
    await watched.until("resilin.status");
    const before = await position(watched, vertex);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 90, y - 30, { steps: 6 });
    await watched.until("resilin.state.grabbed_by === resilin.header.client");
    await watched.until(`Math.hypot(resilin.seenAt(${vertex}).x - ${x}, resilin.seenAt(${vertex}).y - ${y}) > 20`);
    const seen = await watched.value<{ x: number; y: number }>(`resilin.seenAt(${vertex})`);
    assert.ok(seen.x > x + 15, "it follows to the right");
    const pulled = distance(await position(watched, vertex), before);
    await page.mouse.up();
    await watched.until("resilin.state.grabbed_by === null");
    await watched.until(`${distanceFrom(vertex, before)} < ${0.35 * pulled}`);
  });
});

test("pins hold a place, and the ball pushes one", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    const { vertex, x, y } = await grip(watched);
    await page.keyboard.press("2");
    await page.mouse.click(x, y);
    await watched.until("resilin.state.pinned.length === 1");
    // The pin sits on the nearest vertex; a click on it takes it away, unless it moved since it was looked for.
    const isPinned = () => watched.value<boolean>("resilin.state.pinned.length > 0");
    for (const end = Date.now() + 60_000; Date.now() < end && (await isPinned());) {
      const pin = await watched.value<{ x: number; y: number }>("resilin.seenAt(resilin.state.pinned[0])");
      await page.mouse.click(pin.x, pin.y);
      await page.waitForTimeout(500);
    }
    await watched.until("resilin.state.pinned.length === 0");
    await page.keyboard.press("3");
    const before = await position(watched, vertex);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await watched.until("resilin.state.poking");
    await page.mouse.move(x, y + 25, { steps: 5 });
    await watched.until(`${distanceFrom(vertex, before)} > 0.01`);
    await page.mouse.up();
    await watched.until("!resilin.state.poking");
    await page.keyboard.press("1");
  });
});

test("a second page sees the drag of the first, and its controls stay in step", async () => {
  await withPage(browser, program.address, async (first) => {
    await withPage(browser, program.address, async (second) => {
      const { vertex, x, y } = await grip(first);
      const before = await position(second, vertex);
      await first.page.mouse.move(x, y);
      await first.page.mouse.down();
      await first.page.mouse.move(x - 90, y - 20, { steps: 5 });
      await second.until(`${distanceFrom(vertex, before)} > 0.03`);
      assert.equal(await second.value("resilin.state.grabbed_by"), await first.value("resilin.header.client"));
      await first.page.mouse.up();
      await first.value("resilin.send({ type: 'set', key: 'damping', value: 3 })");
      await second.until("resilin.state.values.damping === 3");
      const shown = second.page.getByTestId("set-damping").locator("input:not([type=range])");
      assert.equal(await shown.inputValue(), "3");
      await first.value("resilin.send({ type: 'reload' })");
    });
  });
});

test("a page that stops answering does not stall another", async () => {
  await withPage(browser, program.address, async (stalled) => {
    await withPage(browser, program.address, async (lively) => {
      await stalled.value("resilin.stop()");
      await lively.value("resilin.send({ type: 'set', key: 'damping', value: 0 })");
      await lively.value("resilin.send({ type: 'reset' })"); // it falls, and swings for some seconds
      const drawn = await lively.value<number>("resilin.framesDrawn");
      await lively.until(`resilin.framesDrawn > ${drawn + 12}`);
      const last = await stalled.value<number>("resilin.time");
      await stalled.value("resilin.resume()");
      await stalled.until(`resilin.time > ${last}`);
    });
  });
});

test("a connection that fails is made again by itself", async () => {
  await withPage(browser, program.address, async (watched) => {
    const lost = watched.page.getByTestId("lost");
    await watched.value("resilin.connection.drop()");
    await lost.waitFor({ state: "visible" });
    assert.match(await lost.innerText(), /The connection is lost/);
    await lost.waitFor({ state: "hidden" });
    await reset(watched);
  });
});

test("the program's death is shown, and its new start as well", async () => {
  let mortal = await Program.start(jelly, "--port", "0");
  const watched = await browser.open(mortal.address);
  try {
    await watched.firstFrame();
    const lost = watched.page.getByTestId("lost");
    await mortal.stop();
    await lost.waitFor({ state: "visible" });
    assert.match(await lost.innerText(), /start it again/);
    const { port } = mortal;
    mortal = await Program.start(jelly, "--port", port);
    await watched.page.getByText("new address").waitFor({ state: "visible" });
    await watched.page.goto(mortal.address);
    await watched.firstFrame();
    assert.ok(!(await lost.isVisible()));
    // The browser itself notes the requests that met no program; the page has no faults of its own.
    assert.deepEqual(await watched.value("resilin.errors"), []);
  } finally {
    await watched.close();
    await mortal.stop();
  }
});

test("an open page finds a program that was started again with its file of the address", async () => {
  const kept = path.join(browser.scratch, "address");
  let mortal = await Program.start(jelly, "--port", "0", "--address-file", kept);
  const watched = await browser.open(mortal.address);
  try {
    await watched.firstFrame();
    const lost = watched.page.getByTestId("lost");
    await mortal.stop();
    await lost.waitFor({ state: "visible" });
    const { address } = mortal;
    mortal = await Program.start(jelly, "--address-file", kept);
    assert.equal(mortal.address, address);
    await lost.waitFor({ state: "hidden" });
    await watched.until("resilin.connection.connected && resilin.time > 0");
    assert.deepEqual(await watched.value("resilin.errors"), []);
  } finally {
    await watched.close();
    await mortal.stop();
  }
});

test("fingers drag the body, and two of them come nearer", async () => {
  await withPage(
    browser,
    program.address,
    async (watched) => {
      const { vertex, x, y } = await grip(watched);
      const before = await position(watched, vertex);
      const touch = await watched.touch();
      await touch("touchStart", [{ x, y }]);
      for (let i = 1; i <= 5; ++i) await touch("touchMove", [{ x: x + 12 * i, y }]);
      await watched.until(`${distanceFrom(vertex, before)} > 0.02`);
      await touch("touchEnd", []);
      await watched.until("resilin.state.grabbed_by === null");
      const covered = (await watched.picture()).covered;
      const below = await watched.value<number>("innerHeight - resilin.covered().bottom - 30"); // above the cards
      const at = (x: number) => ({ x, y: below });
      await touch("touchStart", [at(60)]);
      await touch("touchStart", [at(60), at(120)]);
      await touch("touchMove", [at(30), at(150)]);
      await touch("touchEnd", []);
      assert.ok((await watched.picture()).covered > 1.3 * covered, "the body is larger");
    },
    { viewport: { width: 390, height: 780 }, hasTouch: true, deviceScaleFactor: 1 },
  );
});

test("a flat scene is seen from the front and dragged in its plane", async () => {
  const flat = await Program.start(strip, "--port", "0");
  try {
    await withPage(browser, flat.address, async (watched) => {
      const { vertex, x, y } = await grip(watched);
      await watched.page.mouse.move(x, y);
      await watched.page.mouse.down();
      await watched.page.mouse.move(x, y + 60, { steps: 5 });
      await watched.until(`resilin.seenAt(${vertex}).y > ${y + 10}`);
      assert.equal((await position(watched, vertex))[2], 0);
      await watched.page.mouse.up();
    });
  } finally {
    await flat.stop();
  }
});

test("coarse cells show through a skin", async () => {
  const spot = await Program.start(path.join(repository, "examples/spot.toml"), "--port", "0");
  try {
    await withPage(browser, spot.address, async (watched) => {
      assert.deepEqual(await watched.value("resilin.header.parts.map((part) => part.kind)"), ["skin", "cells"]);
      await watched.value("resilin.send({ type: 'pause' })");
      await watched.until("resilin.state.paused");
      await watched.restingTime();
      const skin = await watched.picture();
      await watched.page.keyboard.press("c");
      const through = await watched.picture();
      assert.ok(difference(skin, through) > 0.5, "the picture changes");
      await watched.page.keyboard.press("c");
      assert.ok(difference(skin, await watched.picture()) < 0.2, "and changes back");
    });
  } finally {
    await spot.stop();
  }
});

test("one body is dragged against another, beside a collider that turns", async () => {
  const pair = await Program.start(path.join(webFolder, "tests/scenes/pair.toml"), "--port", "0");
  try {
    await withPage(browser, pair.address, async (watched) => {
      const { page } = watched;
      const first = await watched.value<number[][]>("resilin.colliderPlaces()");
      assert.equal(first.length, 1, "the ground is not among them");
      await watched.until(`Math.abs(resilin.colliderPlaces()[0][0] - ${first[0][0]}) > 0.02`);
      // The left block is led through the place of the right one, which gives way.
      const [left, right] =
        await watched.value<{ first_vertex: number; num_vertices: number }[]>("resilin.header.parts");
      const middle = (part: { first_vertex: number; num_vertices: number }, axis: number) =>
        `Array.from({ length: ${part.num_vertices} }, (_, i) => resilin.position(${part.first_vertex} + i)[${axis}])
           .reduce((sum, value) => sum + value / ${part.num_vertices}, 0)`;
      const start = await watched.value<number>(middle(right, 0));
      const seenMiddle = (part: { first_vertex: number; num_vertices: number }) =>
        watched.value<{ x: number; y: number }>(`(() => {
          const seen = Array.from({ length: ${part.num_vertices} }, (_, i) => resilin.seenAt(${part.first_vertex} + i));
          const mean = (of) => seen.reduce((sum, place) => sum + of(place) / seen.length, 0);
          return { x: mean((place) => place.x), y: mean((place) => place.y) };
        })()`);
      const [from, to] = [await seenMiddle(left), await seenMiddle(right)];
      await page.mouse.move(from.x, from.y);
      await page.mouse.down();
      await watched.until("resilin.state.grabbed_by === resilin.header.client");
      await page.mouse.move(2 * to.x - from.x, 2 * to.y - from.y, { steps: 12 });
      await watched.until(`${middle(right, 0)} > ${start} + 0.05`);
      assert.ok((await watched.value<number>(middle(left, 0))) < (await watched.value<number>(middle(right, 0))));
      await watched.until("resilin.status.active_pairs > 0 && resilin.status.smallest_gap > 0");
      assert.match(await page.getByTestId("contact").innerText(), /^\d.* m · \d+$|^\d.* [mµn]m · \d+$/);
      await page.mouse.up();
      await watched.value("resilin.send({ type: 'set', key: 'contact_friction', value: 0.7 })");
      await watched.until("resilin.state.values.contact_friction === 0.7");
      const colliders = await watched.picture();
      await page.getByTestId("show-colliders").locator("input").click();
      assert.ok(difference(colliders, await watched.picture()) > 0.1, "they can be hidden");
    });
  } finally {
    await pair.stop();
  }
});
