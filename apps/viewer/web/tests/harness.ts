/** Starts the program and a real browser for the tests, and ends both. */

import { spawn, spawnSync, type ChildProcess } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { chromium, firefox, type Browser, type BrowserContext, type Page } from "playwright-core";
import { FIREFOX, VirtualScreen } from "./virtual_screen";

export const webFolder = process.cwd(); // run.mjs says so
export const repository = path.resolve(webFolder, "../../..");
export const program = process.env.RESILIN_PROGRAM ?? path.join(repository, "build/release/apps/cli/resilin");

const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const ARGUMENTS = [
  "--no-sandbox", // containers run as root
  "--disable-gpu",
  "--use-gl=angle",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

/** `resilin view ...` until `stop`. */
export class Program {
  output = "";

  private constructor(
    private readonly child: ChildProcess,
    readonly address: string,
  ) {}

  static async start(...args: string[]): Promise<Program> {
    const child = spawn(program, ["view", ...args, "--no-browser"], { stdio: ["ignore", "pipe", "pipe"] });
    let output = "";
    const address = await new Promise<string>((found, failed) => {
      const read = (text: Buffer) => {
        output += text.toString();
        const match = /http:\/\/127\.0\.0\.1:\d+\/\S*/.exec(output);
        if (match) found(match[0]);
      };
      child.stdout!.on("data", read);
      child.stderr!.on("data", read);
      child.on("exit", (code) => failed(new Error(`resilin view ended with ${code}: ${output}`)));
      setTimeout(() => failed(new Error(`resilin view said no address: ${output}`)), 60_000).unref();
    });
    const started = new Program(child, address);
    started.output = output;
    return started;
  }

  get port(): string {
    return new URL(this.address).port;
  }

  async stop(signal: NodeJS.Signals = "SIGKILL"): Promise<void> {
    if (this.child.exitCode !== null || this.child.signalCode !== null) return;
    const ended = new Promise((done) => this.child.once("exit", done));
    this.child.kill(signal);
    await ended;
  }
}

/** Runs `resilin ARGS` to its end; what it has printed. */
export function runProgram(...args: string[]): string {
  const run = spawnSync(program, args, { encoding: "utf8" });
  if (run.status !== 0) throw new Error(`resilin ${args.join(" ")}: ${run.status}: ${run.stderr}`);
  return run.stdout;
}

export class TestBrowser {
  private constructor(
    private readonly browser: Browser,
    readonly scratch: string,
    private readonly screen: VirtualScreen | null = null,
  ) {}

  static async start(): Promise<TestBrowser> {
    const executablePath = process.env.RESILIN_BROWSER ?? BROWSERS.find((place) => existsSync(place));
    if (!executablePath) throw new Error(`no browser: expected one of ${BROWSERS.join(", ")} or RESILIN_BROWSER`);
    const scratch = mkdtempSync(path.join(os.tmpdir(), "resilin-browser-"));
    const browser = await chromium.launch({ executablePath, headless: true, args: ARGUMENTS, timeout: 60_000 });
    return new TestBrowser(browser, scratch);
  }

  /** Debian's own Firefox, led by WebDriver BiDi. Without a screen it has no WebGL. */
  static async startFirefox(): Promise<TestBrowser> {
    const screen = await VirtualScreen.start();
    const scratch = mkdtempSync(path.join(os.tmpdir(), "resilin-browser-"));
    const env = { ...process.env, DISPLAY: screen.display } as Record<string, string>;
    const launch = { channel: "moz-firefox", executablePath: FIREFOX, headless: false, env, timeout: 60_000 };
    try {
      return new TestBrowser(await firefox.launch(launch), scratch, screen);
    } catch (error) {
      screen.stop();
      throw error;
    }
  }

  /** A page of its own; half as many pixels as a screen has, since they are drawn in software. */
  async open(address: string, options: PageOptions = {}): Promise<Watched> {
    const context = await this.browser.newContext({
      viewport: { width: 1000, height: 700 },
      deviceScaleFactor: 0.5,
      ...options,
    });
    const page = await context.newPage();
    const watched = new Watched(page, context);
    await page.goto(address);
    return watched;
  }

  async stop(): Promise<void> {
    await this.browser.close();
    this.screen?.stop();
    rmSync(this.scratch, { recursive: true, force: true });
  }
}

type PageOptions = Parameters<Browser["newContext"]>[0];

type TouchType = "touchStart" | "touchMove" | "touchEnd";

export interface Picture {
  covered: number; // share of pixels that something is drawn on
  mean: number[]; // mean of the covered pixels, 0 to 255
  colors: number; // different colours in steps of 32
  pixels: number[]; // every pixel of a small copy, for comparison
}

/** A page whose faults are collected. */
export class Watched {
  readonly faults: string[] = [];
  readonly requests: string[] = [];

  constructor(
    readonly page: Page,
    private readonly context: BrowserContext,
  ) {
    page.on("console", (message) => message.type() === "error" && this.faults.push(message.text()));
    page.on("pageerror", (error) => this.faults.push(error.message));
    page.on("request", (request) => this.requests.push(request.url()));
  }

  /** Requests to addresses that begin otherwise, beside data that the page holds itself. */
  requestsBeyond(own: string): string[] {
    return this.requests.filter((url) => ![own, "data:", "blob:"].some((begin) => url.startsWith(begin)));
  }

  async firstFrame(): Promise<void> {
    await this.until("resilin && resilin.framesDrawn > 0");
  }

  /** Waits until `expression` over `resilin` (window.resilin) holds; asked from here, since the page allows no eval. */
  async until(expression: string, timeout = 60_000): Promise<void> {
    const end = Date.now() + timeout;
    while (!(await this.value(expression))) {
      if (Date.now() > end) throw new Error(`waited in vain until ${expression}`);
      await new Promise((done) => setTimeout(done, 25));
    }
  }

  /** The value of `expression` over `resilin`. */
  value<T>(expression: string): Promise<T> {
    return this.page.evaluate(`(() => { const resilin = window.resilin; return ${expression}; })()`) as Promise<T>;
  }

  /** Waits until the simulated time stands still, and returns it [s]. */
  async restingTime(): Promise<number> {
    for (let last = -1; ;) {
      const time = await this.value<number>("resilin.time");
      if (time === last) return time;
      last = time;
      await this.page.waitForTimeout(250);
    }
  }

  /** The canvas itself, without what lies over it. */
  async picture(): Promise<Picture> {
    const script = `(() => {
      window.resilin.drawNow();
      const canvas = document.querySelector("canvas.scene");
      const gl = canvas.getContext("webgl2");
      const { width, height } = canvas;
      const all = new Uint8Array(4 * width * height);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, all);
      const mean = [0, 0, 0], colors = new Set(), pixels = [];
      let covered = 0;
      for (let i = 0; i < all.length; i += 4) {
        if (i % 64 === 0) pixels.push(all[i], all[i + 1], all[i + 2]);
        if (all[i + 3] < 250) continue;
        ++covered;
        for (let k = 0; k < 3; ++k) mean[k] += all[i + k];
        colors.add((all[i] >> 5) * 64 + (all[i + 1] >> 5) * 8 + (all[i + 2] >> 5));
      }
      return { covered: covered / (width * height), mean: mean.map((m) => m / Math.max(covered, 1)),
               colors: colors.size, pixels };
    })()`;
    return (await this.page.evaluate(script)) as Picture;
  }

  /** Sends touches as a screen would. */
  async touch(): Promise<(type: TouchType, touchPoints: { x: number; y: number }[]) => Promise<void>> {
    const session = await this.context.newCDPSession(this.page);
    return async (type, touchPoints) => {
      await session.send("Input.dispatchTouchEvent", { type, touchPoints });
    };
  }

  async close(): Promise<void> {
    await this.context.close();
  }
}

/** Mean difference of two pictures of one size, 0 to 255. */
export function difference(a: Picture, b: Picture): number {
  const sum = a.pixels.reduce((total, value, i) => total + Math.abs(value - b.pixels[i]), 0);
  return sum / a.pixels.length;
}
