/** Files that go into the page by a drop and out of it: meshes, films, pictures. */

import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { MOST_BYTES, whyNot } from "../src/opener";
import { clock } from "../src/recorder";
import { fileName } from "../src/download";
import { Program, repository, TestBrowser, type Watched } from "./harness";
import { jelly, withPage } from "./live_pages";

let browser: TestBrowser;
let program: Program;
const folder = mkdtempSync(path.join(os.tmpdir(), "resilin-files-"));

before(async () => {
  browser = await TestBrowser.start();
  program = await Program.start(jelly, "--port", "0");
});

after(async () => {
  await browser?.stop();
  await program?.stop();
  rmSync(folder, { recursive: true, force: true });
});

const mesh = (name: string) => path.join(repository, "tests/data/meshes", name);

/** Drops files as the system's file manager does. */
async function drop(watched: Watched, files: [name: string, bytes: Buffer][]): Promise<void> {
  const data = files.map(([name, bytes]) => [name, bytes.toString("base64")]);
  await watched.value(`(() => {
    const transfer = new DataTransfer();
    for (const [name, text] of ${JSON.stringify(data)})
      transfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
    const event = (kind) => new DragEvent(kind, { dataTransfer: transfer, bubbles: true, cancelable: true });
    document.body.dispatchEvent(event("dragenter"));
    document.body.dispatchEvent(event("drop"));
  })()`);
}

const title = (watched: Watched) => watched.value<string>("resilin.header?.title ?? ''");

test("a surface that is dropped takes the place of the scene, and garbage is refused in the reader's own words", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    const before = await title(watched);
    const toast = page.getByTestId("toast");
    const refused: [[string, Buffer][], RegExp][] = [
      [[["empty.stl", Buffer.alloc(0)]], /empty\.stl: the file is empty/],
      [[["bad.stl", Buffer.from("solid x\nfacet what")]], /bad\.stl: line 2/],
      [[["photo.png", Buffer.from([0x89, 0x50, 0x4e, 0x47])]], /photo\.png: expected a mesh in one of the formats/],
      [[["a.toml", Buffer.from("x = 1")]], /resilin view a\.toml/],
      [
        [
          ["a.stl", Buffer.from("a")],
          ["b.stl", Buffer.from("b")],
        ],
        /one file at a time/,
      ],
    ];
    for (const [files, words] of refused) {
      await drop(watched, files);
      await page.getByText(words).waitFor();
      assert.equal(await title(watched), before);
    }
    assert.ok(await toast.isVisible());
    for (const name of ["cube_binary.stl", "cube_ascii.ply", "pyramid.obj", "cube_41_binary.msh"]) {
      await drop(watched, [[name, readFileSync(mesh(name))]]);
      await watched.until(`resilin.header?.title === ${JSON.stringify(name)}`);
      await watched.until("resilin.time > 0");
      assert.ok((await watched.picture()).covered > 0.02, name);
    }
    assert.ok(!(await page.getByTestId("busy").isVisible()));
    assert.ok(!(await page.getByTestId("invitation").isVisible()));
    watched.faults.splice(0); // the browser's own words for answers of status 422
  });
});

test("a file is chosen by keys, too, and its name is made harmless", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    writeFileSync(path.join(folder, "a b&c.stl"), readFileSync(mesh("cube_ascii.stl")));
    await page.getByTestId("scene").focus();
    const chosen = page.waitForEvent("filechooser");
    await page.waitForTimeout(300); // until the browser asks the test in place of the user
    await page.keyboard.press("Control+o");
    const chooser = await chosen;
    await chooser.setFiles(path.join(folder, "a b&c.stl"));
    await watched.until("resilin.header?.title === 'a_b_c.stl'");
  });
});

test("only a page of the program may send it a file", async () => {
  const { origin, searchParams } = new URL(program.address);
  const address = `${origin}/open?token=${searchParams.get("token")}&name=cube.stl`;
  const body = readFileSync(mesh("cube_binary.stl"));
  const send = (to: string, headers: Record<string, string>) => fetch(to, { method: "POST", body, headers });
  assert.equal((await send(address, {})).status, 403, "no origin");
  assert.equal((await send(address, { origin: "http://example.com" })).status, 403);
  assert.equal((await send(address.replace(/token=\w+/, "token=wrong"), { origin })).status, 403);
  assert.equal((await fetch(address)).status, 405);
  const answer = await send(address, { origin });
  assert.deepEqual([answer.status, (await answer.text()).trim()], [200, "cube.stl"]);
});

test("a film is recorded with a counter and saved, and a picture has no background", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    await page.getByTestId("scene").focus();
    await page.keyboard.press("v");
    const counter = page.getByTestId("counter");
    await counter.waitFor({ state: "visible" });
    await page.getByText("0:02", { exact: true }).waitFor();
    const [film] = await Promise.all([page.waitForEvent("download"), page.getByTestId("button-record").click()]);
    assert.match(film.suggestedFilename(), /\.webm$/);
    const place = path.join(folder, "film.webm");
    await film.saveAs(place);
    assert.deepEqual([...readFileSync(place).subarray(0, 4)], [0x1a, 0x45, 0xdf, 0xa3], "the signature of Matroska");
    assert.ok(statSync(place).size > 2000, String(statSync(place).size));
    assert.ok(!(await counter.isVisible()));
    const [picture] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("p")]);
    assert.match(picture.suggestedFilename(), /\.png$/);
    const image = path.join(folder, "picture.png");
    await picture.saveAs(image);
    const bytes = readFileSync(image).toString("base64");
    const alphas = await watched.value<{ clear: number; solid: number }>(`(async () => {
      const bytes = Uint8Array.from(atob("${bytes}"), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
      const pen = canvas.getContext("2d");
      pen.drawImage(bitmap, 0, 0);
      const { data } = pen.getImageData(0, 0, bitmap.width, bitmap.height);
      let clear = 0, solid = 0;
      for (let i = 3; i < data.length; i += 4) { clear += data[i] === 0; solid += data[i] === 255; }
      return { clear: clear / (data.length / 4), solid: solid / (data.length / 4) };
    })()`);
    assert.ok(alphas.clear > 0.2 && alphas.solid > 0.02, JSON.stringify(alphas));
  });
});

test("what cannot be opened is said in words", () => {
  const file = { name: "a.stl", size: 5 };
  assert.equal(whyNot([file], [], true), null);
  assert.match(whyNot([], ["meshes"], true)!, /“meshes” is a folder/);
  assert.match(whyNot([file, file], [], true)!, /one file at a time; these are 2/);
  assert.match(whyNot([{ name: "big.stl", size: MOST_BYTES + 1 }], [], true)!, /larger than 256 MiB/);
  assert.match(whyNot([file], [], false)!, /“resilin view a.stl” opens it/);
  assert.equal(clock(67.9), "1:07");
  assert.equal(fileName("Spot: two/one.stl"), "Spot_two_one");
  assert.equal(fileName("../.."), "resilin");
});
