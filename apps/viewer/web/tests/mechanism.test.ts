/** Scenes with joints and cables: sliders of motors, what is drawn of joints, rigid bodies in the hand. */

import assert from "node:assert/strict";
import path from "node:path";
import { after, before, test } from "node:test";
import { Program, repository, runProgram, TestBrowser } from "./harness";
import { withPage } from "./live_pages";

let browser: TestBrowser;

before(async () => {
  browser = await TestBrowser.start();
});

after(() => browser?.stop());

const example = (name: string) => path.join(repository, "examples", `${name}.toml`);

test("a slider drives a motor, the joints move along, and a rigid body can be dragged", async () => {
  const program = await Program.start(example("four_bar"), "--port", "0");
  try {
    await withPage(browser, program.address, async (watched) => {
      const { page } = watched;
      const field = page.getByTestId("set-drive.shaft").locator("input:not([type=range])");
      assert.equal(await watched.value("resilin.header.connectors.length"), 4);
      /** Types an angle, and waits for the crank pin, 0.1 m from the shaft. */
      const turn = async (angle: number) => {
        await field.fill(String(angle));
        await field.press("Enter");
        await field.blur();
        await watched.until(`resilin.state.values["drive.shaft"] === ${angle}`);
        const [x, y] = [-0.1 * Math.sin(angle), 0.1 * Math.cos(angle)];
        await watched.until(
          `(() => { const [u, v] = resilin.connectorPoints()[1][0]; return Math.hypot(u - ${x}, v - ${y}) < 0.003; })()`,
        );
      };
      await turn(-1);
      // A drag far beyond what the linkage can reach ends with a program that answers.
      const vertex = await watched.value<number>(
        "resilin.header.parts.find(({ name }) => name === 'rocker').first_vertex",
      );
      const point = "[0.3, 0, 0]";
      await watched.value(`resilin.send({ type: 'grab', vertex: ${vertex}, point: ${point} })`);
      await watched.until("resilin.status.hand_force !== null");
      for (const x of [9, -9, 40])
        await watched.value(`resilin.send({ type: 'drag', number: ${Math.abs(x)}, target: { x: ${x}, y: 5, z: 0 } })`);
      await page.waitForTimeout(500);
      await watched.value("resilin.send({ type: 'release' })");
      await watched.until("resilin.status.hand_force === null");
      await turn(0.5);
    });
  } finally {
    await program.stop();
  }
});

test("a recording shows its cable from the ground to the body", async () => {
  const folder = path.join(browser.scratch, "rope");
  runProgram("run", example("rope_brake"), "--set", "simulation.end_time=0.05", "--out", folder, "--quiet");
  const watched = await browser.open(`file://${folder}/result.html`);
  try {
    await watched.firstFrame();
    const [points] = await watched.value<number[][][]>("resilin.connectorPoints()");
    assert.equal(points.length, 9);
    assert.deepEqual(points[0], [-0.1, 0.5, 0]);
    assert.ok(Math.hypot(points[8][0] - 0.1, points[8][1] - 0.3) < 0.02);
    assert.deepEqual(watched.faults, []);
  } finally {
    await watched.close();
  }
});
