/** Faces that are held by a click or by keys, and the scene that is saved with them. */

import assert from "node:assert/strict";
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { Program, repository, runProgram, TestBrowser, type Watched } from "./harness";
import { grip, withPage } from "./live_pages";

let browser: TestBrowser;
let program: Program;
const folder = mkdtempSync(path.join(os.tmpdir(), "resilin-hold-"));

/** A box of 2 x 1 x 1 as an STL in text. */
function boxStl(): string {
  const corner = (i: number) => `vertex ${2 * (i & 1)} ${(i >> 1) & 1} ${(i >> 2) & 1}`;
  const sides = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
  ];
  const facets = sides.flatMap(([a, b, c, d]) => [
    [a, b, c],
    [a, c, d],
  ]);
  const text = (facet: number[]) =>
    `facet normal 0 0 0\nouter loop\n${facet.map(corner).join("\n")}\nendloop\nendfacet`;
  return `solid box\n${facets.map(text).join("\n")}\nendsolid box\n`;
}

before(async () => {
  writeFileSync(path.join(folder, "box.stl"), boxStl());
  browser = await TestBrowser.start();
  program = await Program.start(path.join(folder, "box.stl"), "--port", "0");
});

after(async () => {
  await browser?.stop();
  await program?.stop();
  rmSync(folder, { recursive: true, force: true });
});

const held = (watched: Watched) => watched.value<number>("resilin.state.held.length");

test("a click on a face of a surface holds it, a second one frees it, and the saved scene holds the same", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    const { x, y } = await grip(watched);
    await page.keyboard.press("4");
    assert.equal(await watched.value("resilin.tool"), "hold");
    await page.mouse.click(x, y);
    await watched.until("resilin.state.held.length === 1");
    await watched.until("resilin.heldDots() > 0");
    await page.mouse.click(x, y);
    await watched.until("resilin.state.held.length === 0");
    await watched.until("resilin.heldDots() === 0");
    await page.mouse.click(x, y);
    await watched.until("resilin.state.held.length === 1");
    // Held nodes stay where they are, whoever pulls.
    const vertex = await watched.value<number>("resilin.state.held[0].vertices[0]");
    const place = await watched.value<number[]>(`resilin.position(${vertex})`);
    await page.keyboard.press("1");
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 120, y + 60, { steps: 4 });
    await watched.until("resilin.status.hand_force > 0");
    await page.mouse.up();
    const now = await watched.value<number[]>(`resilin.position(${vertex})`);
    for (let k = 0; k < 3; ++k) assert.ok(Math.abs(now[k] - place[k]) < 1e-3, `${now} and ${place}`);
    await page.keyboard.press("Control+s");
    await page.getByText(/Saved with 1 fixed face. Next: resilin run .*box.toml/).waitFor();
  });
  const saved = path.join(folder, "box.toml");
  assert.match(readFileSync(saved, "utf8"), /\[\[fix\]\]\nname = "held_1"\nwhere = \{ vertices = \[/);
  const said = runProgram("run", saved, "--out", path.join(folder, "out"));
  assert.match(said, /converged/);
  assert.equal(readFileSync(path.join(folder, "box.stl"), "utf8"), boxStl());
});

test("faces are held by keys alone, all are freed at once, and the reach is chosen", async () => {
  const jelly = path.join(folder, "jelly.toml");
  copyFileSync(path.join(repository, "apps/viewer/web/tests/scenes/jelly.toml"), jelly);
  const other = await Program.start(jelly, "--port", "0");
  try {
    await withPage(browser, other.address, async (watched) => {
      const { page } = watched;
      await page.getByTestId("scene").focus();
      await page.keyboard.press("4");
      await page.keyboard.press("Enter");
      await watched.until("resilin.state.held.length === 1");
      const whole = await watched.value<number>("resilin.state.held[0].vertices.length");
      await page.keyboard.press("Enter");
      await watched.until("resilin.state.held.length === 0");
      const reach = page.getByTestId("set-face_radius").locator("input:not([type=range])");
      assert.equal(await reach.inputValue(), "no limit");
      await reach.fill("0.25");
      await reach.press("Enter");
      await page.getByTestId("scene").focus();
      await page.keyboard.press("Enter");
      await watched.until("resilin.state.held.length === 1");
      const near = await watched.value<number>("resilin.state.held[0].vertices.length");
      assert.ok(near < whole, `${near} of ${whole}`);
      await page.getByRole("button", { name: "Release all fixed faces" }).click();
      await watched.until("resilin.state.held.length === 0");
      assert.equal(await held(watched), 0);
    });
    assert.ok(!existsSync(path.join(folder, "jelly-2.toml")), "nothing is saved unasked");
  } finally {
    await other.stop();
  }
});
