/** Saved plots, and the buttons of a telephone that lies on its side. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { Program, TestBrowser } from "./harness";
import { strip, withPage } from "./live_pages";

let browser: TestBrowser;
let program: Program;

before(async () => {
  browser = await TestBrowser.start();
  program = await Program.start(strip);
});

after(async () => {
  await browser.stop();
  await program.stop();
});

test("a plot is saved as CSV under the names of its curves, and as PNG", () =>
  withPage(
    browser,
    program.address,
    async (watched) => {
      const chart = watched.page.locator("[data-testid=strip] .chart").last();
      await watched.until("resilin.time > 0.1");
      const saved = async (title: string) => {
        const download = watched.page.waitForEvent("download");
        await chart.locator(`button[title="${title}"]`).click();
        return readFileSync(await (await download).path());
      };
      const lines = (await saved("Save these values as CSV")).toString().trim().split("\n");
      assert.equal(lines[0], "time [s],elastic [J/m],kinetic [J/m]");
      assert.ok(lines.length > 1);
      for (const line of lines.slice(1)) assert.equal(line.split(",").map(Number).filter(Number.isFinite).length, 3);
      assert.equal((await saved("Save this plot as PNG")).subarray(1, 4).toString(), "PNG");
    },
    { viewport: { width: 1440, height: 900 } },
  ));

test("a telephone on its side shows every button of the toolbar, with nothing above it", () =>
  withPage(
    browser,
    program.address,
    async (watched) => {
      const covered = await watched.page.evaluate(() =>
        [...document.querySelectorAll<HTMLElement>(".toolbar button")]
          .filter((button) => !button.hidden)
          .filter((button) => {
            const box = button.getBoundingClientRect();
            const top = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2);
            return !button.contains(top);
          })
          .map((button) => button.title),
      );
      assert.deepEqual(covered, []);
    },
    { viewport: { width: 844, height: 390 }, hasTouch: true, isMobile: true },
  ));
