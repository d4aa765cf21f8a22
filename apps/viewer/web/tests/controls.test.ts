/** Every control of a live scene, in a real browser with the real program behind it. */

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { difference, Program, TestBrowser } from "./harness";
import { jelly, reset, withPage } from "./live_pages";

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

test("every control changes what it says", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    const control = (key: string) => page.getByTestId(`set-${key}`);
    const typed: [string, string, string][] = [
      ["youngs_modulus", "45 kPa", "resilin.state.values.youngs_modulus === 45000"],
      ["poissons_ratio", "0.3", "resilin.state.values.poissons_ratio === 0.3"],
      ["damping", "2", "resilin.state.values.damping === 2"],
      ["gravity", "5", "Math.abs(Math.hypot(...resilin.state.values.gravity) - 5) < 1e-9"],
      ["ground_height", "-0.5", "Math.abs(resilin.state.values.ground_height + 0.5) < 1e-9"],
      ["max_force", "250 N", "resilin.state.values.max_force === 250"],
      ["speed", "0.5", "resilin.state.values.speed === 0.5"],
      ["time_step", "10 ms", "Math.abs(resilin.state.values.time_step - 0.01) < 1e-12"],
      ["newton_limit", "3", "resilin.state.values.newton_limit === 3"],
      ["tolerance", "1e-4", "Math.abs(resilin.state.values.tolerance - 1e-4) < 1e-12"],
    ];
    for (const [key, text, expected] of typed) {
      const field = control(key).locator("input:not([type=range])");
      await field.fill(text);
      await field.press("Enter");
      await field.blur();
      await watched.until(expected);
    }
    const laws = await watched.value<{ name: string; label: string }[]>(
      "resilin.header.controls.find((control) => control.key === 'law').options",
    );
    const other = laws.find((law) => law.name !== "stable_neo_hookean")!;
    await control("law").locator("select").selectOption({ label: other.label });
    await watched.until(`resilin.state.values.law === "${other.name}"`);
    await control("gravity-1").locator("select").selectOption("left");
    await watched.until("resilin.state.values.gravity[0] < -4.9");
    const ground = await watched.value<boolean>("resilin.state.values.ground");
    await control("ground").locator("input").click();
    await watched.until(`resilin.state.values.ground === ${!ground}`);
    await page.getByTestId("scene").focus();
    await page.keyboard.press("g");
    await watched.until(`resilin.state.values.ground === ${ground}`);
    await page.getByText("Reload the scene").click();
    await watched.until("resilin.state.values.youngs_modulus === 30000");
  });
});

test("every control that the program lists is in the panel, with a line of help", async () => {
  await withPage(browser, program.address, async (watched) => {
    const controls = await watched.value<{ key: string; help: string; folder: string }[]>("resilin.header.controls");
    assert.ok(controls.length > 10);
    for (const { key, help } of controls) {
      const widget = watched.page.getByTestId(`set-${key}`);
      assert.equal(await widget.getAttribute("title"), help);
      assert.match(help, /^[A-Z].*[^.]$/, "a line, not a sentence with a full stop");
    }
    assert.deepEqual(
      await watched.value<string[]>("Object.keys(resilin.state.values).sort()"),
      controls.map(({ key }) => key).sort(),
    );
  });
});

test("a slider follows the hand and the program", async () => {
  await withPage(browser, program.address, async (watched) => {
    const slider = watched.page.getByTestId("set-youngs_modulus").locator("input[type=range]");
    const box = (await slider.boundingBox())!;
    await watched.page.mouse.move(box.x + 0.5 * box.width, box.y + box.height / 2);
    await watched.page.mouse.down();
    await watched.page.mouse.move(box.x + 0.8 * box.width, box.y + box.height / 2, { steps: 5 });
    await watched.page.mouse.up();
    await watched.until("resilin.state.values.youngs_modulus > 1e6");
    await watched.value("resilin.send({ type: 'set', key: 'youngs_modulus', value: 30000 })");
    const field = 'document.querySelector("[data-testid=set-youngs_modulus] .number-field")';
    await watched.until(`${field}.value === "30 kPa"`);
  });
});

test("what the program refuses is said in a line, and the control goes back", async () => {
  await withPage(browser, program.address, async (watched) => {
    const was = await watched.value<number>("resilin.state.values.youngs_modulus");
    const field = watched.page.getByTestId("set-youngs_modulus").locator("input:not([type=range])");
    await field.fill("-5");
    await field.press("Enter");
    await field.blur();
    const toast = watched.page.getByTestId("toast");
    await toast.waitFor({ state: "visible" });
    assert.match(await toast.innerText(), /youngs_modulus/);
    assert.equal(await watched.value("resilin.state.values.youngs_modulus"), was);
    assert.equal(await field.inputValue(), "30 kPa");
  });
});

test("the stress along a line between two clicks follows the live scene", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    await watched.value("resilin.send({ type: 'pause' })");
    await watched.until("resilin.state.paused");
    const grabbed = await watched.value("resilin.state.grabbed_by");
    await page.getByTestId("scene").focus();
    await page.keyboard.press("l");
    await watched.until("resilin.header.fields[resilin.shownField]?.name === 'nodal_von_mises'");
    const { x, y } = await watched.value<{ x: number; y: number }>("resilin.middleOfBody()");
    await page.mouse.click(x - 20, y);
    await page.mouse.click(x + 20, y);
    await watched.until("resilin.line?.values.length > 1");
    assert.equal(await watched.value("resilin.state.grabbed_by"), grabbed, "the hand takes nothing meanwhile");
    const first = await watched.value<number[]>("resilin.line.values");
    assert.ok(first.filter(Number.isFinite).every((stress) => stress >= 0));
    assert.match(await page.getByTestId("line-plot").innerText(), /^Von Mises stress, smooth along the line/);
    await watched.value("resilin.send({ type: 'reset' })");
    await watched.value("resilin.send({ type: 'play' })");
    await watched.until(`JSON.stringify(resilin.line.values) !== ${JSON.stringify(JSON.stringify(first))}`);
    await page.keyboard.press("l");
    await page.getByTestId("line-plot").waitFor({ state: "hidden" });
  });
});

test("arrows show a chosen field of vectors, and the card says how large the longest is", async () => {
  await withPage(browser, program.address, async (watched) => {
    const select = watched.page.getByTestId("show-arrows").locator("select");
    assert.deepEqual((await select.locator("option").allInnerTexts()).slice(0, 3), [
      "none",
      "displacement",
      "velocity",
    ]);
    await select.selectOption({ label: "velocity" });
    await watched.value("resilin.send({ type: 'reset' })");
    await watched.until("resilin.arrows().count > 20 && resilin.arrows().longest > 1e-3");
    await watched.until(
      `/longest arrow: velocity .*m.s/.test(document.querySelector("[data-testid=bar-arrows]").textContent)`,
    );
    await watched.until("/arrows=velocity/.test(location.hash)");
    await select.selectOption({ label: "displacement" });
    await watched.until(`/arrow: displacement/.test(document.querySelector("[data-testid=bar-arrows]").textContent)`);
    await select.selectOption({ label: "none" });
    await watched.until("resilin.arrows().count === 0");
    await watched.page.getByTestId("color-bar").waitFor({ state: "hidden" });
  });
});

test("colours differ by field; wireframe and cut change the picture", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    await reset(watched);
    await watched.until("resilin.time > 0.1"); // it has begun to sag, so that fields differ
    await watched.value("resilin.send({ type: 'pause' })");
    await watched.until("resilin.state.paused");
    await watched.restingTime();
    const pictures = new Map([["body colour", await watched.picture()]]);
    const select = page.getByTestId("show-field").locator("select");
    for (const name of ["displacement", "von Mises stress, smooth", "volume ratio, averaged"]) {
      await select.selectOption({ label: name });
      const place = await watched.value<number>(`resilin.header.fields.findIndex((f) => f.label === "${name}")`);
      await watched.until(`resilin.shownField === ${place}`);
      pictures.set(name, await watched.picture());
      assert.match(await page.getByTestId("color-bar").innerText(), new RegExp(name));
    }
    const names = [...pictures.keys()];
    for (const [i, a] of names.entries())
      for (const b of names.slice(i + 1)) {
        const differs = difference(pictures.get(a)!, pictures.get(b)!);
        assert.ok(differs > 0.3, `${a} and ${b} differ by ${differs} of 255`);
      }
    await select.selectOption({ label: "body colour" });
    await watched.until("resilin.shownField === -1");
    const plain = await watched.picture();
    assert.ok(difference(plain, pictures.get("body colour")!) < 0.5, "the body's own colour comes back");
    await page.keyboard.press("w");
    assert.ok(difference(plain, await watched.picture()) > 0.5, "wireframe");
    await page.keyboard.press("w");
    await page.keyboard.press("x");
    const cut = await watched.picture();
    assert.ok(difference(plain, cut) > 1, "cut");
    await page.keyboard.press("x");
    assert.ok(difference(plain, await watched.picture()) < 0.5, "closed again");
    await watched.value("resilin.send({ type: 'play' })");
    await watched.until("!resilin.state.paused");
  });
});

test("pause, step and reset do what they say", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    await reset(watched);
    await page.getByTestId("scene").focus();
    await page.keyboard.press(" ");
    await watched.until("resilin.state.paused");
    const time = await watched.restingTime();
    await page.getByTestId("button-step").click();
    await watched.until(`resilin.time > ${time}`);
    const stepped = await watched.restingTime();
    const step = await watched.value<number>("resilin.state.values.time_step");
    // Times come as 64-bit numbers that sum up many steps.
    assert.ok(Math.abs(stepped - time - step) < 1e-9, `one step: ${stepped - time}`);
    await page.getByTestId("button-reset").click();
    await watched.until("resilin.time === 0");
    await page.getByTestId("button-pause").click();
    await watched.until("resilin.time > 0.05");
  });
});

test("help lists the keys, and the theme can be chosen", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    await page.keyboard.press("?");
    const help = page.getByTestId("help");
    await help.waitFor({ state: "visible" });
    assert.match(await help.innerText(), /single step/);
    await page.keyboard.press("Escape");
    await help.waitFor({ state: "hidden" });
    const background = () =>
      page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue("--sky-2").trim());
    const light = await background();
    await page.getByTestId("show-theme").locator("select").selectOption("dark");
    assert.notEqual(await background(), light);
  });
});
