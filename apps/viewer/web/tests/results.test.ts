/** The page of recorded results in a real browser. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";

import { difference, Program, runProgram, TestBrowser, type Watched, webFolder } from "./harness";
import { bendingBeam, reportOf, writeRecording, writeResultPage } from "./recording_writer";

const beam = bendingBeam(21, 0.4);
let browser: TestBrowser;
let address: string;

before(async () => {
  browser = await TestBrowser.start();
  address = writeResultPage(browser.scratch, "result.html", writeRecording(beam), reportOf(beam));
});

after(() => browser?.stop());

async function withPage(work: (page: Watched) => Promise<void>, where = address): Promise<void> {
  const watched = await browser.open(where);
  try {
    await watched.firstFrame();
    await work(watched);
    assert.deepEqual(watched.faults, []);
    assert.deepEqual(await watched.value("resilin.errors"), []);
  } finally {
    await watched.close();
  }
}

/** Seeks by the slider, as a user does. */
async function seek(watched: Watched, frame: number): Promise<void> {
  await watched.page.getByTestId("timeline").fill(String(frame));
  await watched.until(`resilin.frame === ${frame}`);
}

test("a result page shows its last frame and loads nothing", async () => {
  await withPage(async (watched) => {
    assert.equal(await watched.value("resilin.frame"), 20);
    const picture = await watched.picture();
    assert.ok(picture.covered > 0.02, `covered: ${picture.covered}`);
    assert.deepEqual(
      watched.requests.filter((url) => !url.startsWith("data:") && url !== address),
      [],
    );
    assert.match(await watched.page.getByTestId("timeline-words").innerText(), /frame 20 of 20 · 2\.00 s/);
    const tip = beam.rest.length / 3 - 1;
    const [, y] = await watched.value<number[]>(`resilin.position(${tip})`);
    assert.ok(Math.abs(y - beam.frames[20].places[3 * tip + 1]) < 2e-5);
  });
});

test("the slider scrubs, the keys step, and playing moves on and starts anew", async () => {
  await withPage(async (watched) => {
    const { page } = watched;
    const last = await watched.picture();
    await seek(watched, 0);
    assert.ok(difference(last, await watched.picture()) > 1, "the beam is straight again");
    await page.getByTestId("scene").focus();
    await page.keyboard.press("ArrowRight");
    await watched.until("resilin.frame === 1");
    await page.keyboard.press("End");
    await watched.until("resilin.frame === 20");
    await page.keyboard.press(" ");
    await watched.until("resilin.frame > 2 && resilin.frame < 20");
    await page.keyboard.press(" ");
    const frame = await watched.value<number>("resilin.frame");
    await page.waitForTimeout(400);
    assert.ok((await watched.value<number>("resilin.frame")) <= frame + 1, "it rests");
    await page.getByTestId("speed").selectOption("4");
    await page.getByTestId("timeline-bar").getByTestId("button-play").click();
    await watched.until("resilin.frame === 20");
    await watched.until("resilin.frame < 20");
  });
});

test("fields have their colours and ranges, over all frames or one, or as typed", async () => {
  await withPage(async (watched) => {
    const { page } = watched;
    const greatest = page.getByTestId("bar-greatest");
    const select = page.getByTestId("show-field").locator("select");
    await select.selectOption({ label: "von Mises stress" });
    await watched.until("resilin.shownField === 1");
    assert.equal(await greatest.inputValue(), "10");
    const stress = await watched.picture();
    await select.selectOption({ label: "displacement" });
    await watched.until("resilin.shownField === 0");
    assert.equal(await greatest.inputValue(), "400");
    assert.ok(difference(stress, await watched.picture()) > 1);
    await seek(watched, 10);
    assert.equal(await greatest.inputValue(), "400");
    const overAll = await watched.picture();
    await page.getByTestId("show-range").locator("select").selectOption("this frame");
    assert.equal(await greatest.inputValue(), "200");
    assert.ok(difference(overAll, await watched.picture()) > 0.5);
    await greatest.fill("50");
    await greatest.press("Enter");
    const typed = await watched.picture();
    assert.ok(difference(overAll, typed) > 0.5);
    await page.getByTestId("bar-auto").click();
    assert.equal(await greatest.inputValue(), "200");
    await select.selectOption({ label: "body colour" });
    await watched.until("resilin.shownField === -1");
    assert.ok(!(await page.getByTestId("color-bar").isVisible()));
  });
});

test("a click on the body plots its values over time, beside the curves of the report", async () => {
  await withPage(async (watched) => {
    const { page } = watched;
    const plots = page.getByTestId("plots");
    const text = await plots.innerText();
    for (const title of ["Energy", "Reaction of “wall”", "Displacement of “tip”", "Smallest volume ratio"])
      assert.ok(text.includes(title), `${title} is plotted`);
    const place = await middleOfBody(watched);
    await page.mouse.click(place.x, place.y);
    await watched.until("resilin.probed >= 0");
    const vertex = await watched.value<number>("resilin.probed");
    const probe = page.getByTestId("probe");
    assert.match(await probe.innerText(), new RegExp(`Displacement of vertex ${vertex}`));
    assert.match(await probe.innerText(), new RegExp(`Von Mises stress of vertex ${vertex}`));
    const moved = 1000 * (beam.rest[3 * vertex + 1] - beam.frames[20].places[3 * vertex + 1]);
    const shown = /length ([\d.]+) mm/.exec((await probe.innerText()).replaceAll("\n", " "));
    assert.ok(shown && Math.abs(Number(shown[1]) - moved) < 0.01 * moved, `${shown?.[1]} for ${moved} mm`);
    const canvas = probe.locator("canvas").first();
    assert.ok((await canvas.boundingBox())!.width > 150);
    await page.keyboard.press("Escape");
    assert.match(await probe.innerText(), /Click the body/);
  });
});

test("curves of the report are plotted over another quantity, with a dot at the frame shown", async () => {
  await withPage(async (watched) => {
    const { page } = watched;
    const plots = page.getByTestId("plots");
    const over = page.getByTestId("plots-over");
    assert.deepEqual((await over.locator("option").allInnerTexts()).slice(0, 2), ["time", "Energy, elastic"]);
    await over.selectOption({ label: "Displacement of “tip”, uy" });
    const reaction = plots.locator(".chart").filter({ hasText: "Reaction of “wall”" });
    const saved = async () => {
      const [table] = await Promise.all([page.waitForEvent("download"), reaction.getByTestId("button-table").click()]);
      return readFileSync((await table.path())!, "utf8")
        .trim()
        .split("\n");
    };
    const lines = await saved();
    assert.equal(lines[0], '"Displacement of “tip”, uy [m]",Fx [N],Fy [N],Fz [N]');
    const displacements = lines.slice(1).map((line) => Number(line.split(",")[0]));
    assert.equal(displacements.length, beam.frames.length);
    displacements.forEach((u, step) => assert.ok(Math.abs(u + 0.01 * step) < 1e-12, `${u} at ${step}`));
    // The axis runs from -0.2 m at the left to 0 at the right: a click at the left seeks the last frame, at the right the first.
    const box = (await reaction.locator(".u-over").boundingBox())!;
    await reaction.locator(".u-over").click({ position: { x: box.width - 3, y: box.height / 2 } });
    await watched.until("resilin.frame === 0");
    assert.match(await reaction.innerText(), /Fy 5 N/);
    await reaction.locator(".u-over").click({ position: { x: 3, y: box.height / 2 } });
    await watched.until("resilin.frame === 20");
    await over.selectOption({ label: "time" });
    assert.match((await saved())[0], /^time \[s\],/);
  });
});

async function middleOfBody(watched: Watched): Promise<{ x: number; y: number }> {
  const vertex = Math.floor(beam.rest.length / 6);
  const seen = await watched.value<{ x: number; y: number }>(`resilin.seenAt(${vertex})`);
  for (const [dx, dy] of [
    [0, 0],
    [0, 8],
    [0, -8],
    [8, 0],
    [-8, 0],
    [0, 20],
    [0, -20],
  ]) {
    const [x, y] = [Math.round(seen.x + dx), Math.round(seen.y + dy)];
    if (await watched.value(`resilin.pickAt(${x}, ${y}) !== null`)) return { x, y };
  }
  throw new Error("the body is not where its vertex is seen");
}

test("the address holds the view: camera, frame, field and cut", async () => {
  let shared = "";
  let seen: number[] = [];
  await withPage(async (watched) => {
    const { page } = watched;
    await seek(watched, 7);
    await page.getByTestId("show-field").locator("select").selectOption({ label: "displacement" });
    await page.mouse.move(300, 600);
    await page.mouse.down();
    await page.mouse.move(380, 560, { steps: 4 });
    await page.mouse.up();
    await page.mouse.wheel(0, 200);
    await page.getByTestId("scene").focus();
    await page.keyboard.press("x");
    await watched.until("location.hash.includes('cut=') && location.hash.includes('frame=7')");
    await page.waitForTimeout(400);
    shared = page.url();
    seen = (await watched.picture()).pixels;
  });
  await withPage(async (watched) => {
    await watched.until("resilin.frame === 7 && resilin.shownField === 0");
    const { pixels } = await watched.picture();
    const differs = pixels.reduce((sum, p, i) => sum + Math.abs(p - seen[i]), 0) / pixels.length;
    assert.ok(differs < 0.5, `the picture differs by ${differs} of 255`);
  }, shared);
});

test("what cannot be read is said in a line", async () => {
  const recording = writeRecording(beam);
  const broken = writeResultPage(browser.scratch, "broken.html", recording.subarray(0, 100), {});
  const watched = await browser.open(broken);
  const words = watched.page.getByTestId("reading");
  await watched.page.getByText("cannot be shown").waitFor();
  assert.match(await words.innerText(), /The recording ends inside its header/);
  await watched.close();
  const cut = recording.subarray(0, recording.length - 100);
  await withPage(
    async (whole) => assert.match(await whole.page.locator(".subtitle").innerText(), /20 frames/),
    writeResultPage(browser.scratch, "cut.html", cut, reportOf(beam)),
  );
});

test("a run leaves result.html, and resilin view shows its folder", async () => {
  const folder = path.join(browser.scratch, "jelly");
  runProgram("run", path.join(webFolder, "tests/scenes/jelly.toml"), "--out", folder, "--quiet");
  const report = JSON.parse(readFileSync(path.join(folder, "report.json"), "utf8"));
  const program = await Program.start(folder, "--port", "0");
  try {
    for (const where of [`file://${folder}/result.html`, program.address])
      await withPage(async (watched) => {
        const last = report.frames.length - 1;
        const largest = report.frames.map(
          (frame: { extremes: Record<string, { max: { value: number } }> }) => frame.extremes.nodal_von_mises.max.value,
        );
        const telling = largest.indexOf(Math.max(...largest));
        await watched.until(`resilin.frame === ${telling}`);
        await seek(watched, last);
        // The corner's displacement in the recording is that of its probe in the report, to the recording's
        // quantum.
        const corner = await watched.value<number>(
          "(() => { for (let v = 0; ; ++v) if (resilin.restPosition(v).every((x) => x > 0.999)) return v; })()",
        );
        const [x, y, z] = await watched.value<number[]>(`resilin.position(${corner})`);
        const { displacement } = report.frames[last].probes.corner;
        [x - 1, y - 1, z - 1].forEach((u, i) => assert.ok(Math.abs(u - displacement[i]) < 1e-4));
        // Fields that the scene did not ask for: the program computes them, a small page has them with it.
        const select = watched.page.getByTestId("show-field").locator("select");
        const labels = (await select.locator("option").allInnerTexts()).map((label) => label.trim());
        const wanted = ["pressure, averaged", "principal stress 1, averaged", "Cauchy stress xy, averaged"];
        wanted.push("displacement z", "velocity", "von Mises stress, smooth", "von Mises stress, averaged");
        if (where === program.address) wanted.push("pressure, smooth");
        for (const label of wanted) {
          assert.ok(labels.includes(label), `${label} of ${labels}`);
          await select.selectOption({ label });
          const place = `resilin.header.fields.findIndex((field) => field.label === "${label}")`;
          await watched.until(`resilin.shownField === ${place}`);
        }
        await seek(watched, 0);
        assert.ok((await watched.picture()).covered > 0.02);
      }, where);
  } finally {
    await program.stop();
  }
});
