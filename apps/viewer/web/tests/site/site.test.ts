/** The built site, $RESILIN_SITE, in a real browser: scripts/check_site.py builds it and starts this. */

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import path from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { TestBrowser, type Watched } from "../harness";
import { grip, withoutModule } from "../live_pages";

const site = process.env.RESILIN_SITE!;
const TYPES: Record<string, string> = {
  ".html": "text/html",
  ".css": "text/css",
  ".js": "text/javascript",
  ".svg": "image/svg+xml",
  ".png": "image/png",
  ".webp": "image/webp",
  ".mp4": "video/mp4",
};
const PAGES = [
  "index.html",
  "examples/index.html",
  "examples/twisted_bar.html",
  "docs/scene.html",
  "docs/validation.html",
  "docs/theory/real_time.html",
  "reference/commands.html",
  "reference/python.html",
  "genindex.html",
];

let browser: TestBrowser;
let server: Server;
let served: string; // "http://127.0.0.1:PORT/"
const onDisk = pathToFileURL(site).href + "/";

before(async () => {
  browser = await TestBrowser.start();
  server = createServer(async (request, answer) => {
    const place = decodeURIComponent(new URL(request.url!, "http://here").pathname);
    try {
      const content = await readFile(path.join(site, place));
      answer.writeHead(200, { "content-type": TYPES[path.extname(place)] ?? "application/octet-stream" }).end(content);
    } catch {
      answer.writeHead(404).end();
    }
  });
  await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
  served = `http://127.0.0.1:${(server.address() as AddressInfo).port}/`;
});

after(async () => {
  await browser?.stop();
  server?.closeAllConnections();
  server?.close();
});

/** Nothing went wrong in the page, and nothing was asked of anyone but the site. */
function isSound(watched: Watched, root: string): void {
  assert.deepEqual(watched.faults, []);
  assert.deepEqual(watched.requestsBeyond(root), []);
}

/** Faults of the layout that a reader would notice. */
const faultsOfLayout = (watched: Watched) =>
  watched.page.evaluate(`(async () => {
    const faults = [];
    // The window never scrolls, by the theme, but the article would: all has to end before the edge of the window that is
    // not in a part with a bar of its own.
    const scrolls = (part) => ["auto", "scroll"].includes(getComputedStyle(part).overflowX);
    const lost = (part) => {
      if (part.getBoundingClientRect().right < innerWidth + 1) return false;
      for (let holder = part; !holder.matches("article"); holder = holder.parentElement) if (scrolls(holder)) return false;
      return true;
    };
    const wide = [...document.querySelectorAll("article *")].find(lost);
    if (wide) faults.push("beyond the edge: " + wide.outerHTML.slice(0, 200));
    const pictures = [...document.querySelectorAll("article img")];
    for (const picture of pictures) picture.loading = "eager";
    await Promise.all(pictures.map((picture) => picture.decode().catch(() => faults.push("no picture: " + picture.src))));
    const brightness = (color) => color.match(/[\\d.]+/g).slice(0, 3).reduce((sum, part) => sum + Number(part) / 765, 0);
    const ground = brightness(getComputedStyle(document.body).backgroundColor);
    const words = brightness(getComputedStyle(document.querySelector("article h1")).color);
    if (Math.abs(ground - words) < 0.5) faults.push("words of brightness " + words + " on " + ground);
    if (ground > 0.5 !== matchMedia("(prefers-color-scheme: light)").matches) faults.push("ground of brightness " + ground);
    return faults;
  })()`);

const SCREENS: [string, object][] = [
  ["a desktop", { viewport: { width: 1280, height: 800 } }],
  ["a telephone", { viewport: { width: 390, height: 844 }, hasTouch: true, deviceScaleFactor: 1 }],
];

for (const [screen, options] of SCREENS)
  for (const colorScheme of ["light", "dark"] as const)
    test(`site: pages fit ${screen}, ${colorScheme}, with all their pictures, and ask nothing of other hosts`, async () => {
      const watched = await browser.open("about:blank", { ...options, colorScheme });
      for (const page of PAGES) {
        await watched.page.goto(served + page);
        assert.deepEqual(await faultsOfLayout(watched), [], page);
      }
      isSound(watched, served);
      await watched.close();
    });

for (const where of ["a server", "disk"])
  test(`site: from ${where} the search finds a page, and the gallery leads to a film`, async () => {
    const root = where === "disk" ? onDisk : served;
    const watched = await browser.open(`${root}index.html`);
    const { page } = watched;
    await page.locator("input.sidebar-search").fill("activation_distance");
    await page.keyboard.press("Enter");
    await page.locator("#search-results a", { hasText: /^Contact and friction$/ }).click();
    await page.locator("h1", { hasText: "Contact and friction" }).waitFor();
    await page.goto(`${root}examples/index.html`);
    await page.locator('.card[href$="twisted_bar.html"]').click();
    const film = page.locator(".stage video");
    await film.waitFor();
    await page.waitForFunction("document.querySelector('.stage video').currentTime > 0"); // it plays where it is seen
    assert.deepEqual(await watched.page.evaluate("document.querySelector('.stage video').error"), null);
    isSound(watched, root);
    await watched.close();
  });

test("site: the search finds each word of the glossary at its place", async () => {
  const glossary = await readFile("../../../docs/glossary.md", "utf8"); // from apps/viewer/web
  const rows = glossary.split("## From a word to the place")[1]!.matchAll(/^\| (.*) \| (.*) \|$/gm);
  const wanted: [string, string][] = [...rows].slice(2).flatMap(([, words, place]) => {
    const link = /\]\(([^)#]+)\.md/.exec(place!)![1]!;
    return words!.split(", ").map((word): [string, string] => [word.replaceAll("`", ""), `docs/${link}`]);
  });
  assert.ok(wanted.length > 80);
  const watched = await browser.open(`${served}search.html?q=x`);
  await watched.page.waitForFunction("Search.hasIndex()");
  const found = (word: string) =>
    watched.page.evaluate(
      `Search._performSearch(...Search._parseQuery(${JSON.stringify(word)})).slice(-3).map((hit) => hit[0])`,
    ) as Promise<string[]>;
  for (const [word, page] of wanted) assert.ok((await found(word)).includes(page), `${word}: ${page}`);
  await watched.close();
});

test("site: a scene of the gallery is pulled at", { skip: withoutModule }, async () => {
  const watched = await browser.open(`${served}examples/jelly_cube.html`);
  const { page } = watched;
  await page.getByText("Play with it here").click();
  await watched.firstFrame();
  await watched.until("resilin.state && resilin.status && resilin.status.at_rest", 120_000);
  const { vertex, x, y } = await grip(watched);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 90, y - 30, { steps: 6 });
  await watched.until("resilin.state.grabbed_by === resilin.header.client");
  await watched.until(`resilin.seenAt(${vertex}).x > ${x + 15}`);
  await page.mouse.up();
  isSound(watched, served);
  await watched.close();
});
