/** The pages in Firefox: a live scene, one that carries its solver, and a recorded result. */

import assert from "node:assert/strict";
import path from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { difference, Program, runProgram, TestBrowser, type Watched } from "./harness";
import { grip, jelly, module, withPage, withoutModule } from "./live_pages";
import { bendingBeam, reportOf, writeRecording, writeResultPage } from "./recording_writer";
import { lackOfFirefox } from "./virtual_screen";

const lack = lackOfFirefox();
const options = { skip: lack ?? false };
const playing = { skip: lack ?? withoutModule };
let browser: TestBrowser;

before(async () => {
  if (lack === null) browser = await TestBrowser.startFirefox();
});

after(() => browser?.stop());

/** Pulls at the body by the mouse: it is seen to follow, and swings back. */
async function pull(watched: Watched): Promise<void> {
  const { mouse } = watched.page;
  const { vertex, x, y } = await grip(watched);
  const isMoved = `Math.hypot(resilin.seenAt(${vertex}).x - ${x}, resilin.seenAt(${vertex}).y - ${y}) > 20`;
  await mouse.move(x, y);
  await mouse.down();
  await mouse.move(x + 90, y - 30, { steps: 6 });
  await watched.until("resilin.state.grabbed_by === resilin.header.client");
  await watched.until(`resilin.seenAt(${vertex}).x > ${x + 15} && ${isMoved}`); // it may swing before it hangs there
  await mouse.up();
  await watched.until("resilin.state.grabbed_by === null");
  await watched.until(`resilin.seenAt(${vertex}).x < ${x + 10}`); // it may hang lower than where it was gripped
}

test("Firefox: a body of a live scene follows the mouse, keys and sliders act", options, async () => {
  const program = await Program.start(jelly, "--port", "0");
  try {
    await withPage(browser, program.address, async (watched) => {
      const { page } = watched;
      const picture = await watched.picture();
      assert.ok(picture.covered > 0.04 && picture.colors > 4, `${picture.covered}, ${picture.colors} colours`);
      await pull(watched);
      await page.keyboard.press("Space");
      await watched.until("resilin.state.paused");
      const slider = page.getByTestId("set-youngs_modulus").locator("input[type=range]");
      const stiffness = "resilin.state.values.youngs_modulus";
      const before = await watched.value<number>(stiffness);
      const at = (await slider.boundingBox())!;
      await page.mouse.click(at.x + 0.95 * at.width, at.y + at.height / 2);
      await watched.until(`${stiffness} > ${2 * before}`);
      assert.deepEqual(watched.requestsBeyond(new URL(program.address).origin), []);
    });
  } finally {
    await program.stop();
  }
});

test("Firefox: a page from disk carries its solver, and its body follows the mouse", playing, async () => {
  const page = path.join(browser.scratch, "play.html");
  runProgram("export", jelly, page, "--engine", module);
  await withPage(browser, pathToFileURL(page).href, async (watched) => {
    await pull(watched);
    await watched.until("resilin.status.step_ms > 0");
    assert.deepEqual(watched.requestsBeyond("file:"), []);
  });
});

test("Firefox: a recorded result is played, scrubbed by the mouse, coloured and cut", options, async () => {
  const beam = bendingBeam(21, 0.4);
  const address = writeResultPage(browser.scratch, "result.html", writeRecording(beam), reportOf(beam));
  const watched = await browser.open(address);
  const { page } = watched;
  await watched.firstFrame();
  assert.equal(await watched.value("resilin.frame"), 20);
  const last = await watched.picture();
  const timeline = (await page.getByTestId("timeline").boundingBox())!;
  await page.mouse.click(timeline.x + timeline.width / 2, timeline.y + timeline.height / 2);
  await watched.until("resilin.frame > 7 && resilin.frame < 13");
  const middle = await watched.picture();
  assert.ok(difference(last, middle) > 0.5, "the beam is bent less");
  const select = page.getByTestId("show-field").locator("select");
  const [first, second] = await select.locator("option").allInnerTexts();
  assert.ok(second !== undefined, first);
  const shown = await watched.value<number>("resilin.shownField");
  await select.selectOption({ index: shown === 0 ? 0 : 1 });
  await watched.until(`resilin.shownField !== ${shown}`);
  assert.ok(difference(middle, await watched.picture()) > 0.5, "other colours");
  const colored = await watched.picture();
  await page.getByTestId("scene").focus();
  await page.keyboard.press("x");
  assert.ok(difference(colored, await watched.picture()) > 0.5, "half of it is cut away");
  const frame = await watched.value<number>("resilin.frame");
  await page.keyboard.press("Space");
  await watched.until(`resilin.frame > ${frame}`);
  assert.deepEqual(watched.faults, []);
  assert.deepEqual(await watched.value("resilin.errors"), []);
  await watched.close();
});
