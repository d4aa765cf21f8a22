/** Undo of what a button has removed, and units of a scene in 2D. */

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Program, TestBrowser, type Watched } from "./harness";
import { grip, jelly, strip, withPage } from "./live_pages";

let browser: TestBrowser;

before(async () => {
  browser = await TestBrowser.start();
});

after(() => browser.stop());

async function withScene(scene: string, work: (page: Watched) => Promise<void>): Promise<void> {
  const program = await Program.start(scene);
  try {
    await withPage(browser, program.address, work, { viewport: { width: 1440, height: 900 } });
  } finally {
    await program.stop();
  }
}

const buttonCases = [
  { key: "4", button: "Release all fixed faces", count: "resilin.state.held.length" },
  { key: "5", button: "Remove all face loads", count: "resilin.state.loads.length" },
];

for (const { key, button, count } of buttonCases)
  test(`undo brings back what "${button}" has removed, also a second time`, () =>
    withScene(jelly, async (watched) => {
      const { x, y } = await grip(watched);
      await watched.page.keyboard.press(key);
      await watched.page.mouse.click(x, y);
      await watched.until(`${count} === 1`);
      for (let time = 0; time < 2; ++time) {
        await watched.page.getByText(button).click();
        await watched.until(`${count} === 0`);
        await watched.page.keyboard.press("Control+z");
        await watched.until(`${count} === 1`);
      }
    }));

test("energies of a live scene in 2D are those of a metre of depth", () =>
  withScene(strip, async (watched) => {
    const legend = watched.page.locator("[data-testid=strip] .chart-legend").last();
    for (const end = Date.now() + 60_000; !/J.m/.test((await legend.textContent()) ?? "");) {
      assert.ok(Date.now() < end, `legend: ${await legend.textContent()}`);
      await watched.page.waitForTimeout(100);
    }
    assert.match((await legend.textContent()) ?? "", /elastic .*J\/m.*kinetic .*J\/m/);
  }));
