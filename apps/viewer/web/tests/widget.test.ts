/** The page in an output cell of a notebook: the widget's own module, with a model whose other end is the program. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import type { Frame } from "playwright-core";
import { Program, repository, TestBrowser, webFolder, type Watched } from "./harness";
import { grip, jelly } from "./live_pages";

const widget = readFileSync(path.join(repository, "python/resilin/widget.js"), "utf8");
const html = readFileSync(path.join(webFolder, "dist/page.html"), "utf8").replace(
  '{"kind": "live"}',
  '{"kind": "hosted"}',
);

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

/** Model of a notebook for the widget: it stands for the Python side, here the sockets of `resilin view`. */
const NOTEBOOK = `async ({ widget, html, live }) => {
  const listeners = [], sockets = new Map();
  const notebook = { said: [], live: 0 };
  const tell = (content, ...buffers) => [...listeners].forEach((hear) => hear(content, buffers));
  const open = (page) => {
    sockets.get(page)?.close();
    const socket = new WebSocket(live);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => sockets.get(page) !== socket ? null
      : typeof data === "string" ? tell({ page, kind: "text", text: data })
      : tell({ page, kind: "bytes" }, new DataView(data));
    sockets.set(page, socket);
  };
  const model = {
    get: (name) => ({ title: "Jelly", height: 600 })[name],
    on: (_, hear) => listeners.push(hear),
    off: (_, hear) => listeners.splice(listeners.indexOf(hear), 1),
    send(content, _, buffers) {
      const { page, kind } = content;
      notebook.said.push(kind);
      if (kind === "html") setTimeout(() => tell({ page, kind }, new DataView(new TextEncoder().encode(html).buffer)));
      else if (kind === "open") open(page);
      else if (kind === "close") sockets.get(page).close();
      else sockets.get(page).send(kind === "text" ? content.text : buffers[0]);
    },
  };
  const cell = document.createElement("div");
  document.body.replaceChildren(cell);
  const address = URL.createObjectURL(new Blob([widget], { type: "text/javascript" }));
  const { render } = (await import(address)).default;
  notebook.leave = render({ model, el: cell });
  notebook.end = (words) => sockets.forEach((_, page) => tell({ page, kind: "end", text: words }));
  notebook.move = () => { const other = document.createElement("div"); document.body.append(other); other.append(...cell.children); };
  window.notebook = notebook;
}`;

/** The value of `expression` over `resilin` of the page in the cell. */
function value<T>(frame: Frame, expression: string): Promise<T> {
  return frame.evaluate(`(() => { const resilin = window.resilin; return ${expression}; })()`) as Promise<T>;
}

async function until(watched: Watched, expression: string): Promise<Frame> {
  for (const end = Date.now() + 20_000; Date.now() < end; await watched.page.waitForTimeout(25)) {
    const frame = watched.page.frames().find((one) => one.parentFrame() !== null);
    if (frame && (await value<boolean>(frame, `Boolean(resilin && (${expression}))`).catch(() => false))) return frame;
  }
  const said = await watched.page.evaluate("notebook.said.join()");
  throw new Error(`waited in vain until ${expression}; said: ${said}; faults: ${watched.faults.join("; ")}`);
}

test("a widget shows the scene, carries a pull to it, and says when it is gone", async () => {
  // An address of the program's origin that has no page of its own; what that one may not do a notebook's may.
  const watched = await browser.open(new URL("/", program.address).href, { bypassCSP: true });
  const { page } = watched;
  const live = program.address.replace("http", "ws").replace("/?", "/live?");
  await page.evaluate(`(${NOTEBOOK})(${JSON.stringify({ widget, html, live })})`);
  let frame = await until(watched, "resilin.framesDrawn > 0 && resilin.state");
  assert.equal(await value(frame, "resilin.header.saves"), true); // as the program says; a notebook's says no

  const held = await grip({ value: (expression) => value(frame, expression) });
  const place = await page.locator("iframe").boundingBox();
  const [x, y] = [Math.round(place!.x + held.x), Math.round(place!.y + held.y)];
  const before = await value<number[]>(frame, `resilin.position(${held.vertex})`);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 90, y - 30, { steps: 6 });
  await until(watched, "resilin.state.grabbed_by === resilin.header.client");
  await until(
    watched,
    `Math.hypot(...resilin.position(${held.vertex}).map((x, i) => x - ${JSON.stringify(before)}[i])) > 0.03`,
  );
  await page.mouse.up();
  await until(watched, "resilin.state.grabbed_by === null");

  // A cell that is moved loads its page anew, and the page finds its scene again.
  await page.evaluate("notebook.move()");
  frame = await until(watched, "resilin.framesDrawn > 0 && resilin.state");
  assert.equal(await page.evaluate("notebook.said.filter((kind) => kind === 'open').length"), 2);

  await page.evaluate("notebook.end('The scene has ended.')");
  await frame.getByText("The scene has ended.").waitFor();
  await page.evaluate("notebook.leave()");
  assert.equal(await page.evaluate("notebook.said.at(-1)"), "close");
  const faults = watched.faults.filter((fault) => !fault.includes("status of 403")); // without faults of that address
  assert.deepEqual(faults, []);
  await watched.close();
});
