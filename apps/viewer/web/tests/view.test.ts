/** Bodies, camera, loads on faces, undo and plots: what one does with a scene of several bodies. */

import assert from "node:assert/strict";
import { copyFileSync, readFileSync } from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { difference, Program, runProgram, TestBrowser, type Watched, webFolder } from "./harness";
import { withPage } from "./live_pages";

let browser: TestBrowser;
let program: Program;
let scene: string;

before(async () => {
  browser = await TestBrowser.start();
  scene = path.join(browser.scratch, "two_blocks.toml");
  copyFileSync(path.join(webFolder, "tests/scenes/two_blocks.toml"), scene);
  program = await Program.start(scene, "--port", "0");
});

after(async () => {
  await program?.stop();
  await browser?.stop();
});

/** Where a vertex at the top of a body is seen: the middle of a face that looks upwards. */
const topOf = (watched: Watched, x: number) =>
  watched.value<{ x: number; y: number }>(`resilin.project(${x}, 0.2, 0.39)`);

test("each body has its own material, is hidden and seen through, and a saved scene holds what was changed", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    const field = page.getByTestId("set-youngs_modulus").locator(".number-field");
    assert.equal(await field.inputValue(), "50 kPa");
    await page.getByTestId("body-1").click();
    await watched.until(`document.querySelector("[data-testid=set-youngs_modulus] .number-field").value === "200 kPa"`);
    await field.fill("300 kPa");
    await field.press("Enter");
    await watched.until("resilin.state.bodies[1].youngs_modulus === 3e5");
    assert.equal(await watched.value("resilin.state.bodies[0].youngs_modulus"), 5e4);

    const whole = await watched.picture();
    await page.getByTestId("show-body-soft").click();
    const one = await watched.picture();
    assert.ok(one.covered < 0.8 * whole.covered, `${one.covered} of ${whole.covered} without a body`);
    await page.getByTestId("show-body-soft").click();
    await page.getByTestId("opacity-soft").fill("0.3");
    const thin = await watched.picture();
    assert.ok(difference(thin, whole) > 0.5, "one is seen through");

    await page.getByTestId("scene").focus();
    await page.keyboard.press("Control+s");
    await watched.until(`/two_blocks-2/.test(document.querySelector("[data-testid=toast]").textContent)`);
    const saved = readFileSync(scene.replace(".toml", "-2.toml"), "utf8");
    assert.match(saved, /youngs_modulus = 300000|youngs_modulus = 3e\+?0?5/);
    assert.match(saved, /youngs_modulus = 50000|youngs_modulus = 5e\+?0?4/);
    assert.doesNotMatch(saved, /\[contact\]|contact =|damping/);
    runProgram("run", scene.replace(".toml", "-2.toml"), "--out", path.join(browser.scratch, "saved"), "--quiet");

    await page.keyboard.press("Control+z");
    await watched.until("resilin.state.bodies[1].youngs_modulus === 2e5");
  });
});

test("a click puts a force on a face, a second one takes it away, and both can be undone", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    await page.getByTestId("button-settle").click();
    await watched.until("resilin.status.at_rest");
    await page.getByTestId("scene").focus();
    await page.keyboard.press("5");
    const at = await topOf(watched, -0.4);
    const vertex = await watched.value<number>(`resilin.pickAt(${at.x}, ${at.y}).vertex`);
    const height = await watched.value<number>(`resilin.position(${vertex})[2]`);
    await page.mouse.click(at.x, at.y);
    await watched.until("resilin.loadedFaces() === 1");
    await page.keyboard.press("q");
    await watched.until(`resilin.status.at_rest && resilin.position(${vertex})[2] < ${height} - 1e-4`);
    await page.keyboard.press("Control+z");
    await watched.until("resilin.loadedFaces() === 0");
    await page.mouse.click(at.x, at.y);
    await watched.until("resilin.loadedFaces() === 1");
    await page.keyboard.press("Control+s");
    await watched.until(`/two_blocks-3/.test(document.querySelector("[data-testid=toast]").textContent)`);
    const saved = readFileSync(scene.replace(".toml", "-3.toml"), "utf8");
    assert.match(saved, /name = "load_1"/);
    runProgram("run", scene.replace(".toml", "-3.toml"), "--out", path.join(browser.scratch, "loaded"), "--quiet");
    await page.mouse.click(at.x, at.y);
    await watched.until("resilin.loadedFaces() === 0");
  });
});

test("the ends of the axes are standard views, and lines of sight may be parallel", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    const spread = async () => {
      const [low, high] = await watched.value<{ x: number; y: number }[]>(
        "[resilin.project(0, 0.2, 0), resilin.project(0, 0.2, 0.4)]",
      );
      return Math.hypot(low.x - high.x, low.y - high.y);
    };
    assert.ok((await spread()) > 20, "the height is seen");
    await page.getByTestId("button-parallel").click();
    await watched.until("resilin.isParallel()");
    await page.getByTestId("look-z").click({ force: true });
    await page.waitForTimeout(200);
    assert.ok((await spread()) < 1, "from above, without perspective, the height is a point");
    await page.getByTestId("look-x").click({ force: true });
    await page.waitForTimeout(200);
    assert.ok((await spread()) > 20);
    assert.ok((await watched.picture()).covered > 0.005, "the bodies are drawn");
    await page.getByTestId("button-see-all").click();
    await page.getByTestId("scene").focus();
    await page.keyboard.press("o");
    await watched.until("!resilin.isParallel()");
  });
});

test("edges of a box are drawn, colours can be chosen, and the value under the pointer is said", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    await watched.until("resilin.numCreases() > 0");
    await page.getByTestId("show-field").locator("select").selectOption({ label: "displacement" });
    await watched.until("resilin.shownField >= 0");
    const colours = await watched.picture();
    await page.getByTestId("show-colorMap").locator("select").selectOption("diverging");
    assert.ok(difference(await watched.picture(), colours) > 0.5);
    const at = await topOf(watched, -0.4);
    await page.mouse.move(at.x, at.y);
    await watched.until(`/m$/.test(document.querySelector("[data-testid=pointed]").textContent)`);
    assert.ok(await page.getByTestId("pointed").isVisible());
    await page.mouse.move(3, 350);
    await watched.until(`document.querySelector("[data-testid=pointed]").hidden`);
    await page.getByTestId("scene").focus();
    await page.keyboard.press("e");
    await watched.until("resilin.numCreases() === 0");
  });
});

test("in results the displacement may be drawn larger, a field is plotted along a line, and loads grow", async () => {
  const folder = path.join(browser.scratch, "results");
  runProgram("run", scene, "--out", folder, "--quiet", "--set", "simulation.load_steps=4");
  const watched = await browser.open(`file://${folder}/result.html`);
  try {
    await watched.firstFrame();
    const { page } = watched;
    await watched.value("resilin.seek(4)");
    await watched.until("resilin.frame === 4");
    assert.deepEqual(await watched.value("resilin.loadFactors()"), [1]);
    await watched.value("resilin.seek(2)");
    await watched.until("resilin.frame === 2");
    const [half] = await watched.value<number[]>("resilin.loadFactors()");
    assert.ok(Math.abs(half - 0.5) < 1e-6, `the load is ${half} at half of the way`);

    const vertex = await watched.value<number>("resilin.header.parts[0].num_vertices - 1");
    const moved = async () => {
      const [now, rest] = await watched.value<number[][]>(
        `[resilin.position(${vertex}), resilin.restPosition(${vertex})]`,
      );
      return Math.hypot(...now.map((x, i) => x - rest[i]));
    };
    const once = await moved();
    const field = page.getByTestId("show-deformation").locator(".number-field");
    await field.fill("5");
    await field.press("Enter");
    await page.waitForTimeout(300);
    const five = await moved();
    assert.ok(once === 0 || Math.abs(five / once - 5) < 1e-3, `${five} for ${once}`);
    assert.match(await page.getByTestId("bar-note").innerText(), /scaled by 5/);
    await field.fill("1");
    await field.press("Enter");

    await page.getByTestId("button-line").click();
    const [from, to] = [await topOf(watched, 0.25), await topOf(watched, 0.55)];
    await page.mouse.click(from.x, from.y);
    await page.mouse.click(to.x, to.y);
    await watched.until("resilin.line && resilin.line.values.length > 1");
    const { distances } = await watched.value<{ distances: number[] }>("resilin.line");
    assert.ok(distances.every((d, i) => i === 0 || d >= distances[i - 1]));
    assert.match(await page.getByTestId("line-plot").innerText(), /along the line/);
    const [table] = await Promise.all([
      page.waitForEvent("download"),
      page.getByTestId("line-plot").getByTestId("button-table").click(),
    ]);
    assert.match(readFileSync((await table.path())!, "utf8"), /^distance \[m\],/);
    assert.deepEqual(watched.faults, []);
  } finally {
    await watched.close();
  }
});
