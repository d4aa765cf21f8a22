/** A screen that nobody sees, for a browser that draws in three dimensions on screens alone. */

import { spawn, type ChildProcess } from "node:child_process";
import { existsSync } from "node:fs";
import type { Readable } from "node:stream";

export const FIREFOX = "/usr/bin/firefox-esr";
const SERVER = "/usr/bin/Xvfb";

/** Names in words what is missing to run Firefox; null when nothing is. */
export function lackOfFirefox(): string | null {
  const missing = [FIREFOX, SERVER].filter((place) => !existsSync(place));
  return missing.length === 0 ? null : `no ${missing.join(", no ")}: apt-get install firefox-esr xvfb`;
}

export class VirtualScreen {
  private constructor(
    private readonly child: ChildProcess,
    readonly display: string, // ":3"
  ) {}

  static async start(): Promise<VirtualScreen> {
    const options = ["-displayfd", "3", "-screen", "0", "1280x1024x24", "-nolisten", "tcp"];
    const child = spawn(SERVER, options, { stdio: ["ignore", "ignore", "ignore", "pipe"] });
    const number = await new Promise<string>((found, failed) => {
      let told = "";
      (child.stdio[3] as Readable).on("data", (text: Buffer) => {
        told += text.toString();
        if (told.endsWith("\n")) found(told.trim());
      });
      child.on("error", failed);
      child.on("exit", (code) => failed(new Error(`${SERVER} ended with ${code}`)));
    });
    return new VirtualScreen(child, `:${number}`);
  }

  stop(): void {
    this.child.kill();
  }
}
