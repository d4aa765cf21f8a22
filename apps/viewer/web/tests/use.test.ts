/** How the page is used: by keys alone, on small screens, in the dark, on slow machines, with wrong numbers. */

import assert from "node:assert/strict";
import path from "node:path";
import { after, before, test } from "node:test";
import { difference, Program, repository, TestBrowser, type Watched } from "./harness";
import { distanceFrom, jelly, position, withPage } from "./live_pages";

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

const focused = (watched: Watched) => watched.value<string>("document.activeElement?.dataset?.testid ?? ''");

test("a tool is chosen, a body is taken and led, and the camera turned by keys alone", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    for (let i = 0; i < 20 && (await focused(watched)) !== "button-pin"; ++i) await page.keyboard.press("Tab");
    assert.equal(await focused(watched), "button-pin");
    const paused = await watched.value("resilin.state.paused");
    await page.keyboard.press(" ");
    assert.equal(await watched.value("resilin.tool"), "pin");
    await page.waitForTimeout(200);
    assert.equal(await watched.value("resilin.state.paused"), paused, "Space chooses the tool and pauses nothing");
    assert.equal(await focused(watched), "button-pin", "who goes by Tab keeps the place");
    await page.getByTestId("scene").focus();
    await page.keyboard.press("1");
    await page.keyboard.press("Enter");
    await watched.until("resilin.state.grabbed_by === resilin.header.client");
    assert.ok(await page.getByTestId("crosshair").isVisible());
    const vertex = await watched.value<number>("resilin.held().vertex");
    const before = await position(watched, vertex);
    for (let i = 0; i < 8; ++i) await page.keyboard.press("ArrowRight");
    await watched.until(`${distanceFrom(vertex, before)} > 0.02`);
    await page.keyboard.press("Enter");
    await watched.until("resilin.state.grabbed_by === null");
    const seen = await watched.picture();
    await page.keyboard.press("Shift+ArrowLeft");
    const turned = await watched.picture();
    assert.ok(difference(seen, turned) > 1, "it turns");
    for (let i = 0; i < 3; ++i) await page.keyboard.press("+");
    assert.ok((await watched.picture()).covered > 1.1 * turned.covered, "it comes nearer");
    await page.keyboard.press("Escape");
    await page.keyboard.press("Escape");
    assert.ok(!(await page.getByTestId("crosshair").isVisible()));
  });
});

test("caps lock changes nothing, and the help has the keys while it is open", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    await page.getByTestId("scene").focus();
    const plain = await watched.picture();
    await watched.value("resilin.send({ type: 'pause' })");
    await page.keyboard.press("W");
    assert.ok(difference(plain, await watched.picture()) > 0.5, "W is w");
    await page.keyboard.press("w");
    await page.keyboard.press("?");
    const dialog = page.getByRole("dialog");
    await dialog.waitFor({ state: "visible" });
    for (let i = 0; i < 3; ++i) {
      assert.equal(await watched.value("document.activeElement.closest('[role=dialog]') !== null"), true);
      await page.keyboard.press("Tab");
    }
    await page.keyboard.press("Escape");
    await dialog.waitFor({ state: "hidden" });
    assert.equal(await focused(watched), "scene");
    await watched.value("resilin.send({ type: 'play' })");
  });
});

test("every control has a name for those who do not see it", async () => {
  await withPage(browser, program.address, async (watched) => {
    const nameless = await watched.value<
      string[]
    >(`[...document.querySelectorAll("button, input, select, canvas.scene, [role=img]")]
      .filter((control) => control.getClientRects().length > 0)
      .filter((control) => !(control.getAttribute("aria-label") || control.title || control.textContent.trim() ||
        (control.getAttribute("aria-labelledby") ?? "").split(" ").some((id) => document.getElementById(id)?.textContent)))
      .map((control) => control.outerHTML.slice(0, 120))`);
    assert.deepEqual(nameless, []);
  });
});

interface Box {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** The window's place of all that is drawn of the bodies. */
const bodyBox = (watched: Watched) =>
  watched.value<Box>(`(() => {
    const box = { left: 1e9, right: -1e9, top: 1e9, bottom: -1e9 };
    const count = resilin.header.parts[0].num_vertices;
    for (let v = 0; v < count; ++v) {
      const { x, y } = resilin.seenAt(v);
      box.left = Math.min(box.left, x); box.right = Math.max(box.right, x);
      box.top = Math.min(box.top, y); box.bottom = Math.max(box.bottom, y);
    }
    return box;
  })()`);

/** Cards that lie over the box, and words that are cut off. */
const faultsOfLayout = (watched: Watched, box: Box) =>
  watched.value<string[]>(`(() => {
    const faults = [];
    const body = ${JSON.stringify(box)};
    for (const card of document.querySelectorAll(".card, .head-up, .lil-root")) {
      const at = card.getBoundingClientRect();
      if (at.width * at.height === 0 || card.closest(".veil")) continue;
      if (at.left < body.right && at.right > body.left && at.top < body.bottom && at.bottom > body.top)
        faults.push("over the body: " + (card.dataset.testid || card.className));
      if (at.left < -1 || at.right > innerWidth + 1 || at.top < -1 || at.bottom > innerHeight + 1)
        faults.push("outside of the window: " + card.className);
    }
    for (const words of document.querySelectorAll("h1, .words, .timeline-words, .item b"))
      if (words.getClientRects().length > 0 && words.scrollWidth > words.clientWidth + 1 && getComputedStyle(words).display !== "inline")
        faults.push("cut off: " + words.textContent);
    const tools = [...document.querySelectorAll(".toolbar .icon")].filter((b) => b.getClientRects().length > 0);
    const rows = new Set(tools.map((b) => Math.round(b.getBoundingClientRect().top)));
    if (rows.size > (innerWidth < 720 ? 2 : 1)) faults.push("the tools stand in " + rows.size + " rows");
    if (matchMedia("(pointer: coarse)").matches)
      for (const button of document.querySelectorAll(".icon, .lil-root > .lil-title")) {
        const { width, height } = button.getBoundingClientRect();
        if (width * height > 0 && Math.min(width, height) < 40)
          faults.push("too small for a finger: " + button.title + " " + width + " x " + height);
      }
    const title = document.querySelector("h1").getBoundingClientRect();
    if (title.height < 18) faults.push("the title is " + title.height + " pixels high");
    return faults;
  })()`);

const SCREENS: [string, object][] = [
  ["a telephone", { viewport: { width: 390, height: 780 }, hasTouch: true, deviceScaleFactor: 1 }],
  ["a telephone on its side", { viewport: { width: 844, height: 390 }, hasTouch: true, deviceScaleFactor: 1 }],
  ["a small laptop", { viewport: { width: 1024, height: 700 }, deviceScaleFactor: 0.5 }],
  ["a desktop", { viewport: { width: 1600, height: 950 }, deviceScaleFactor: 0.5 }],
];

for (const [name, options] of SCREENS)
  test(`nothing covers the body and no word is cut off on ${name}`, async () => {
    await withPage(
      browser,
      program.address,
      async (watched) => {
        await watched.until("resilin.status");
        await watched.value("resilin.send({ type: 'pause' })");
        await watched.until("resilin.state.paused");
        await watched.page.getByTestId("scene").focus();
        await watched.page.keyboard.press("f");
        await watched.page.waitForTimeout(200);
        const box = await bodyBox(watched);
        assert.ok(box.right - box.left > 80 && box.bottom - box.top > 80, `seen large enough: ${JSON.stringify(box)}`);
        assert.deepEqual(await faultsOfLayout(watched, box), []);
        await watched.value("resilin.send({ type: 'play' })");
      },
      options,
    );
  });

test("however much there is to say, the strip leaves the cards beside it free, and tells all under the pointer", async () => {
  await withPage(
    browser,
    program.address,
    async (watched) => {
      const { page } = watched;
      await watched.until("resilin.status");
      await watched.value("resilin.send({ type: 'pause' })");
      await watched.until("resilin.state.paused");
      const words = page.getByTestId("words");
      const isCovered = `(() => {
        const top = document.querySelector(".head-up").getBoundingClientRect().top;
        const cards = [...document.querySelectorAll(".lil-root, .strip")].map((card) => card.getBoundingClientRect());
        return cards.some((card) => card.bottom > top);
      })()`;
      const said = "a body has an estimated discretisation error of 20 %; take finer cells; ".repeat(12);
      await watched.value(`document.querySelector(".words").textContent = ${JSON.stringify(said)}`);
      assert.equal(await watched.value(isCovered), false);
      const height = (await words.boundingBox())!.height;
      await words.hover();
      assert.ok((await words.boundingBox())!.height > 1.9 * height);
      await watched.value("resilin.send({ type: 'play' })");
    },
    { viewport: { width: 1280, height: 800 } },
  );
});

test("on a telephone a button opens the words that are cut off", async () => {
  await withPage(
    browser,
    program.address,
    async (watched) => {
      const { page } = watched;
      await watched.until("resilin.status");
      await watched.value("resilin.send({ type: 'pause' })");
      await watched.until("resilin.state.paused");
      const words = page.getByTestId("words");
      const more = page.getByTestId("words-more");
      const said = "a body has an estimated discretisation error of 20 %; take finer cells; ".repeat(6);
      await watched.value(`document.querySelector(".warning-words").textContent = ${JSON.stringify(said)}`);
      await page.setViewportSize({ width: 392, height: 780 }); // the strip looks again for what is cut off
      await more.waitFor({ state: "visible" });
      const height = (await words.boundingBox())!.height;
      await more.tap();
      assert.equal(await more.getAttribute("aria-expanded"), "true");
      const box = (await words.boundingBox())!;
      assert.ok(box.height > 1.9 * height, `${box.height} after ${height}`);
      assert.ok(box.y > 0 && box.y + box.height < 780, "all of it is in the window");
      await more.tap();
      assert.ok((await words.boundingBox())!.height < height + 1, "it closes again");
      await watched.value("resilin.send({ type: 'play' })");
    },
    { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true, deviceScaleFactor: 1 },
  );
});

test("the page follows the system into the dark", async () => {
  const lightness = async (colorScheme: "light" | "dark") => {
    let seen = 0;
    await withPage(
      browser,
      program.address,
      async (watched) => {
        const { page } = watched;
        assert.equal(await watched.value("document.documentElement.dataset.theme"), colorScheme);
        const [r, g, b] = await watched.value<number[]>(
          "getComputedStyle(document.querySelector('h1')).color.match(/\\d+/g).map(Number)",
        );
        seen = r + g + b;
        await page.emulateMedia({ colorScheme: colorScheme === "light" ? "dark" : "light" });
        await watched.until(`document.documentElement.dataset.theme !== "${colorScheme}"`);
      },
      { colorScheme },
    );
    return seen;
  };
  assert.ok((await lightness("dark")) > (await lightness("light")) + 300, "letters are light in the dark");
});

/** Makes each frame of the page take this long, as on a machine that draws in software. */
const slowly = (milliseconds: number) => `(() => {
  const ask = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (draw) => ask((now) => {
    const end = performance.now() + ${milliseconds};
    while (performance.now() < end);
    draw(performance.now());
  });
})()`;

test("slow drawing becomes light by itself, and may be chosen", async () => {
  const watched = await browser.open("about:blank");
  try {
    const { page } = watched;
    await page.addInitScript(slowly(130));
    await page.goto(program.address);
    await watched.firstFrame();
    await watched.until("resilin.state");
    const pixels = () => watched.value<number>("document.querySelector('canvas.scene').width");
    const before = await pixels();
    await watched.value("resilin.send({ type: 'reset' })");
    await watched.until("resilin.isLight");
    assert.equal(await watched.value("document.documentElement.dataset.drawing"), "light");
    assert.equal(
      await watched.value("getComputedStyle(document.querySelector('.card')).backdropFilter"),
      "none",
      "cards are not blurred",
    );
    assert.ok((await pixels()) <= before);
    await page.getByTestId("show-drawing").locator("select").selectOption("full");
    await watched.until("!resilin.isLight");
  } finally {
    await watched.close();
  }
  await withPage(browser, program.address, async (swift) => {
    await swift.page.waitForTimeout(1000);
    assert.equal(await swift.value("document.documentElement.dataset.drawing ?? 'full'"), "full", "a quick one stays");
  });
});

test("values out of range are refused with a word, and none is changed in silence", async () => {
  await withPage(browser, program.address, async (watched) => {
    const { page } = watched;
    const toast = page.getByTestId("toast");
    const type = async (key: string, text: string) => {
      const field = page.getByTestId(`set-${key}`).locator("input:not([type=range])");
      await field.fill(text);
      await field.press("Enter");
      return field;
    };
    await type("poissons_ratio", "0.499");
    await watched.until("resilin.state.values.poissons_ratio === 0.499");
    const nu = await type("poissons_ratio", "0.6");
    await page.getByText(/poissons_ratio: expected a number from -0.9 to 0.4999, got 0.6/).waitFor();
    assert.equal(await nu.inputValue(), "0.499");
    const damping = await type("damping", "abc");
    await page.getByText(/“abc” is not a number/).waitFor();
    assert.notEqual(await damping.inputValue(), "abc");
    const comma = await type("damping", "0,5");
    await page.getByText("“0,5” is not a number. Write decimals with a point: 0.5.").waitFor();
    assert.notEqual(await comma.inputValue(), "0,5");
    const ball = await type("poke_radius", "-1");
    await page.getByText(/Ball radius .*: expected a number from .* to .*, got/).waitFor();
    assert.ok(Number(await ball.inputValue()) > 0);
    const limit = page.getByTestId("set-newton_limit").locator("input:not([type=range])");
    assert.equal(await limit.inputValue(), "no limit");
    await type("newton_limit", "7");
    await watched.until("resilin.state.values.newton_limit === 7");
    await type("newton_limit", "no limit");
    await watched.until("resilin.state.values.newton_limit === 0");
    assert.ok(await toast.isVisible());
    const kinds = await watched.value<string[]>(
      `[...new Set([...document.querySelectorAll(".panel input[type=range]")].map((slider) => slider.className))]`,
    );
    assert.deepEqual(kinds, ["number-slider"], "one kind of slider");
    await watched.value("resilin.send({ type: 'reload' })");
  });
});

test("a mesh without a scene is shown, soft and weightless", async () => {
  const mesh = path.join(repository, "data/spot_coarse.msh");
  const bare = await Program.start(mesh, "--port", "0");
  try {
    assert.match(bare.output, /is a mesh without a scene/);
    await withPage(browser, bare.address, async (watched) => {
      await watched.until("resilin.position(0).length === 3");
      assert.ok((await watched.picture()).covered > 0.02);
      assert.equal(await watched.value("Math.hypot(...resilin.state.values.gravity)"), 0);
    });
  } finally {
    await bare.stop();
  }
});
