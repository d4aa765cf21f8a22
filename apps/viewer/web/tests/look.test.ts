/** Appearance of a scene, found by content: shade, stresses, modes, the inside, marks. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { difference, Program, runProgram, TestBrowser, type Watched, webFolder } from "./harness";
import { jelly, withPage } from "./live_pages";

let browser: TestBrowser;

before(async () => {
  browser = await TestBrowser.start();
});

after(() => browser?.stop());

const scene = (name: string) => path.join(webFolder, "tests/scenes", name);

/** Runs a scene and opens its result.html. */
async function withResults(name: string, work: (page: Watched, folder: string) => Promise<void>, more = {}) {
  const folder = path.join(browser.scratch, name.replace(".toml", ""));
  runProgram("run", scene(name), "--out", folder, "--quiet");
  const watched = await browser.open(`file://${folder}/result.html`, more);
  try {
    await watched.firstFrame();
    await work(watched, folder);
    assert.deepEqual(watched.faults, []);
    assert.deepEqual(await watched.value("resilin.errors"), []);
  } finally {
    await watched.close();
  }
}

/** Mean lightness of the page's canvas around places of the scene, 0 to 255 of what is drawn on white. */
async function lightnessAt(watched: Watched, places: number[][]): Promise<number[]> {
  return watched.value(`(() => {
    resilin.drawNow();
    const canvas = document.querySelector("canvas.scene");
    const gl = canvas.getContext("webgl2");
    const scale = canvas.width / canvas.clientWidth;
    return ${JSON.stringify(places)}.map((place) => {
      const { x, y } = resilin.project(...place);
      const pixel = new Uint8Array(4);
      gl.readPixels(Math.round(x * scale), canvas.height - 1 - Math.round(y * scale), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      return (pixel[0] + pixel[1] + pixel[2]) / 3 + 255 - pixel[3];
    });
  })()`);
}

test("the shade on the ground lies under what is near it, not mirrored", async () => {
  const program = await Program.start(scene("hovering.toml"), "--port", "0");
  try {
    await withPage(browser, program.address, async (watched) => {
      const { page } = watched;
      await page.getByTestId("scene").focus();
      await watched.value("resilin.send({ type: 'pause' })");
      await page.keyboard.press("g");
      await watched.until("resilin.state.ground !== null && resilin.state.paused");
      await page.waitForTimeout(300);
      // The ground before the box that lies on it, and as far before the one that hovers.
      const xs = [0.05, 0.15, 0.25, 0.35];
      const [near, far] = [-0.03, 1.23].map((y) => xs.map((x) => [x, y, 0]));
      const [atNear, atFar] = [await lightnessAt(watched, near), await lightnessAt(watched, far)];
      xs.forEach((x, i) => assert.ok(atNear[i] < atFar[i] - 5, `at x = ${x}: ${atNear[i]} and ${atFar[i]}`));
    });
  } finally {
    await program.stop();
  }
});

test("page, picture and report name a stress alike and agree to the digits shown", async () => {
  await withResults("tower.toml", async (watched, folder) => {
    const report = JSON.parse(readFileSync(path.join(folder, "report.json"), "utf8"));
    const { extremes } = report.frames[report.frames.length - 1];
    const { page } = watched;
    const select = page.getByTestId("show-field").locator("select");
    assert.notEqual(extremes.von_mises.min.value, extremes.nodal_von_mises.min.value);
    const bar = page.getByTestId("color-bar");
    await page.getByTestId("show-range").locator("select").selectOption("this frame");
    for (const [name, label] of [
      ["nodal_von_mises", "von Mises stress, smooth"],
      ["displacement", "displacement"],
    ]) {
      await select.selectOption({ label });
      await watched.until(`resilin.header.fields[resilin.shownField].label === "${label}"`);
      assert.ok((await bar.innerText()).startsWith(label), await bar.innerText());
      const unit = /\[(.*)\]/.exec(await bar.innerText())![1];
      const factor = { k: 1e3, m: 1e-3 }[unit[0]] ?? 1;
      for (const [end, place] of [
        ["greatest", "max"],
        ["least", "min"],
      ] as const) {
        const shown = await page.getByTestId(`bar-${end}`).inputValue();
        const reported = extremes[name][place].value / (unit === "m" ? 1 : factor);
        assert.ok(agrees(shown, reported), `${label}: the page has ${shown} ${unit}, the report ${reported}`);
      }
      const picture = path.join(folder, "picture.png");
      const said = runProgram("picture", folder, "--field", name, "--out", picture);
      const [, title, drawnUnit, drawn] = /pixels; (.*) \[(.*)\]: min \S+ +max (\S+)/.exec(said)!;
      assert.equal(title, label);
      const drawnFactor = { k: 1e3, m: 1e-3 }[drawnUnit[0]] ?? 1;
      const largest = extremes[name].max.value / (drawnUnit === "m" ? 1 : drawnFactor);
      assert.ok(agrees(drawn, largest), `${label}: the picture has ${drawn} ${drawnUnit}, the report ${largest}`);
    }
    const said = runProgram("picture", folder, "--field", "von_mises", "--out", path.join(folder, "cells.png"));
    const [, title, drawn] = /pixels; (.*) \[kPa\]: min \S+ +max (\S+)/.exec(said)!;
    assert.equal(title, "von Mises stress, by cell");
    assert.ok(agrees(drawn, extremes.von_mises.max.value / 1e3));
    const labels = await select.locator("option").allInnerTexts();
    assert.ok(!labels.some((label) => label.trim() === "von Mises stress"), "no name without what it is");
  });
});

/** Whether `shown` is `value`, rounded to as many digits. */
function agrees(shown: string, value: number): boolean {
  const text = shown.replace("\u2212", "-");
  const decimals = (text.split(".")[1] ?? "").length;
  return Math.abs(Number(text) - value) <= 0.51 * 10 ** -decimals;
}

test("modes have their frequencies, swing and sound", async () => {
  await withResults("chime.toml", async (watched, folder) => {
    const { page } = watched;
    const report = JSON.parse(readFileSync(path.join(folder, "report.json"), "utf8"));
    const words = page.getByTestId("timeline-words");
    const bending = report.modes.find((mode: { rigid: boolean }) => !mode.rigid);
    assert.match(await words.innerText(), new RegExp(`^mode ${bending.number} of 9 · [\\d.]+ k?Hz$`));
    const [, number, prefix] = /· ([\d.]+) (k?)Hz/.exec(await words.innerText())!;
    const shown = Number(number) * (prefix ? 1000 : 1);
    assert.ok(Math.abs(shown / bending.frequency - 1) < 1e-3, `${shown} for ${bending.frequency} Hz`);
    const plots = await page.getByTestId("plots").innerText();
    assert.match(plots, /frequency \[Hz\]|Frequency/);
    assert.doesNotMatch(plots, /Energy|Newton/);
    // It swings to both sides of its rest.
    await page.getByTestId("scene").focus();
    await page.keyboard.press(" ");
    await watched.until("resilin.swing < -0.5");
    await watched.until("resilin.swing > 0.5");
    await page.keyboard.press(" ");
    await page.getByTestId("button-sound").click();
    assert.ok(Math.abs((await watched.value<number>("resilin.tone()")) / bending.frequency - 1) < 1e-9);
    await page.getByTestId("timeline").fill("1");
    assert.match(await words.innerText(), /rigid-body mode/);
    assert.equal(await watched.value("resilin.tone()"), null);
    const said = runProgram(
      "picture",
      folder,
      "--frame",
      String(bending.number),
      "--out",
      path.join(folder, "mode.png"),
    );
    assert.match(said, /displacement|von Mises/);
  });
});

test("a cut shows the field inside, and coarse cells do not depend on the order of triangles", async () => {
  await withResults("tower.toml", async (watched) => {
    const { page } = watched;
    await page.getByTestId("scene").focus();
    await page.keyboard.press("x");
    await watched.until("resilin.section() !== null");
    const { least, greatest, count } = await watched.value<{ least: number; greatest: number; count: number }>(`(() => {
      resilin.drawNow();
      const { values, count } = resilin.section();
      return { least: Math.min(...values), greatest: Math.max(...values), count };
    })()`);
    assert.ok(
      count > 100 && least >= 0 && greatest <= 1 && greatest > least + 0.15,
      `${count}: ${least} to ${greatest}`,
    );
    const withField = await watched.picture();
    await page.getByTestId("show-field").locator("select").selectOption({ label: "body colour" });
    await watched.until("resilin.shownField === -1 && resilin.section() === null");
    assert.ok(difference(withField, await watched.picture()) > 1);
  });
});

test("a rigid body, which has no stress, keeps its own colour beside a coloured one, and arrows are in sight", async () => {
  await withResults("rigid_beside.toml", async (watched) => {
    await watched.value("resilin.seek(1)");
    await watched.until("resilin.frame === 1");
    assert.equal(await watched.value("resilin.header.fields[resilin.shownField].name"), "nodal_von_mises");
    // Neither the colour of what is no number nor one of the bar, but that of the second body.
    const [r, g, b] = await watched.value<number[]>(`(() => {
      resilin.drawNow();
      const canvas = document.querySelector("canvas.scene");
      const gl = canvas.getContext("webgl2");
      const scale = canvas.width / canvas.clientWidth;
      const { x, y } = resilin.project(1.63, 0.42, 0);
      const pixel = new Uint8Array(4);
      gl.readPixels(Math.round(x * scale), canvas.height - 1 - Math.round(y * scale), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      return [...pixel];
    })()`);
    assert.ok(b > g && g > r && r > 60, `the rigid body is blue: ${[r, g, b]}`);
    // Arrows of loads are within what "fit the view" shows.
    await watched.page.getByTestId("button-see-all").click();
    const box = await watched.value<number[]>("resilin.arrowBox()");
    assert.equal(box.length, 6);
    const covered = await watched.value<{ left: number; right: number; top: number; bottom: number }>(
      "resilin.covered()",
    );
    for (const [x, y] of [
      [box[0], box[1]],
      [box[3], box[4]],
    ]) {
      const seen = await watched.value<{ x: number; y: number }>(`resilin.project(${x}, ${y}, 0)`);
      assert.ok(seen.x > covered.left && seen.x < 1000 - covered.right, `${seen.x} in ${JSON.stringify(covered)}`);
      assert.ok(seen.y > covered.top && seen.y < 700 - covered.bottom, `${seen.y} in ${JSON.stringify(covered)}`);
    }
  });
});

test("supports, loads and probes are drawn where they are, and the hand says how strongly it pulls", async () => {
  const program = await Program.start(scene("tower.toml"), "--port", "0");
  try {
    await withPage(browser, program.address, async (watched) => {
      const { page } = watched;
      // As it stands at the start: the tower bends far.
      await watched.value("resilin.send({ type: 'pause' })");
      await watched.until("resilin.state.paused");
      await watched.value("resilin.send({ type: 'reset' })");
      await watched.until("resilin.time === 0 && resilin.position(0).length === 3");
      const marks = await watched.value<{ kind: string; name: string; y: number }[]>("resilin.marksSeen()");
      const kinds = Object.fromEntries(marks.map((mark) => [`${mark.kind} ${mark.name}`, mark]));
      assert.deepEqual(Object.keys(kinds).sort(), ["load wind", "probe top", "support foot"]);
      assert.ok(kinds["support foot"].y > kinds["probe top"].y + 100, "the foot is below the top");
      assert.equal(await page.getByTestId("label-probe-top").innerText(), "top");
      const drawn = await watched.picture();
      await page.getByTestId("scene").focus();
      await page.keyboard.press("m");
      assert.ok(difference(drawn, await watched.picture()) > 0.2, "the marks go");
      assert.ok(!(await page.getByTestId("label-probe-top").isVisible()));
      await watched.value("resilin.send({ type: 'play' })");
      const { x, y } = await watched.value<{ x: number; y: number }>("resilin.middleOfBody()");
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 80, y, { steps: 4 });
      await page.getByTestId("label-hand").waitFor({ state: "visible" });
      assert.match(await page.getByTestId("label-hand").innerText(), /^[\d.]+ [mk]?N$/);
      await page.mouse.up();
      await page.getByTestId("label-hand").waitFor({ state: "hidden" });
    });
  } finally {
    await program.stop();
  }
});

test("what is nothing up to rounding has no colours of rounding", async () => {
  const program = await Program.start(jelly, "--port", "0", "--set", "simulation.gravity=[0,0,0]");
  try {
    await withPage(browser, program.address, async (watched) => {
      const { page } = watched;
      for (const label of ["velocity", "von Mises stress, averaged"]) {
        await page.getByTestId("show-field").locator("select").selectOption({ label });
        await watched.until(`resilin.header.fields[resilin.shownField]?.label === "${label}"`);
        const scale = await watched.value<number>(`resilin.header.fields[resilin.shownField].scale`);
        const [unit] = /\[.*\]/.exec(await page.getByTestId("color-bar").innerText())!;
        const factor = { n: 1e-9, µ: 1e-6, m: 1e-3, k: 1e3 }[unit[1]] ?? 1;
        const width =
          Number(await page.getByTestId("bar-greatest").inputValue()) -
          Number(await page.getByTestId("bar-least").inputValue());
        assert.ok(width * (unit === "[m/s]" ? 1 : factor) >= 0.9e-9 * scale, `${label}: ${width} ${unit} of ${scale}`);
      }
    });
  } finally {
    await program.stop();
  }
});
