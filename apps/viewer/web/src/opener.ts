/** Files that are opened on the page, dropped on it or chosen from the disk: they go to the program. */

import { element } from "./dom";
import type { Overlays } from "./overlays";

export const MOST_BYTES = 256 * 2 ** 20; // limit of the program

/** How a file reaches the program; throws an Error with its words. Null: this page has none that reads files. */
export type SendFile = ((file: File) => Promise<void>) | null;

/** Why these cannot be opened, in words; null: they can. `folders` are names. */
export function whyNot(files: { name: string; size: number }[], folders: string[], reads: boolean): string | null {
  const [first] = files;
  if (folders.length > 0) return `“${folders[0]}” is a folder; drop one mesh file.`;
  if (files.length > 1) return `Drop one file at a time; these are ${files.length}.`;
  if (!reads)
    return `This page shows one scene and reads no files. Where Resilin is installed, “resilin view ${first.name}” opens it.`;
  if (/\.toml$/i.test(first.name))
    return `“${first.name}” is a scene, which names other files: “resilin view ${first.name}” opens it.`;
  if (first.size > MOST_BYTES)
    return `“${first.name}” is larger than ${MOST_BYTES / 2 ** 20} MiB, the most that a page may send; “resilin view ${first.name}” opens it.`;
  return null;
}

export class Opener {
  private readonly input = element("input", { type: "file", hidden: true, data: "file", "aria-label": "a mesh file" });
  private reading: string | null = null; // the name of the file that is under way

  constructor(
    private readonly send: SendFile,
    private readonly overlays: Overlays,
  ) {
    this.input.addEventListener("change", () => {
      const files = [...(this.input.files ?? [])];
      this.input.value = ""; // the same file may be chosen again
      if (files.length > 0) void this.open(files, []);
    });
    overlays.root.append(this.input);
    let inside = 0; // dragenter less dragleave, of all elements below
    const holdsFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
    const end = () => overlays.invite(((inside = 0), false));
    addEventListener("dragenter", (event) => holdsFiles(event) && overlays.invite(++inside > 0));
    addEventListener("dragleave", (event) => holdsFiles(event) && --inside <= 0 && end());
    addEventListener("dragover", (event) => event.preventDefault()); // else the browser leaves for the file
    addEventListener("drop", (event) => {
      event.preventDefault();
      end();
      if (event.dataTransfer) this.dropped(event.dataTransfer);
    });
  }

  /** Lets the user choose a file. */
  choose(): void {
    if (this.send) this.input.click();
    else this.overlays.say(whyNot([{ name: "FILE", size: 0 }], [], false)!);
  }

  private dropped({ items, files }: DataTransfer): void {
    const folders = [...items]
      .map((item) => item.webkitGetAsEntry?.())
      .filter((entry) => entry?.isDirectory)
      .map((entry) => entry!.name);
    if (files.length > 0) void this.open([...files], folders);
  }

  private async open(files: File[], folders: string[]): Promise<void> {
    const words = whyNot(files, folders, this.send !== null);
    if (words !== null) return this.overlays.say(words);
    if (this.reading !== null) return this.overlays.say(`“${this.reading}” is still being read; wait for it.`);
    const [file] = files;
    this.reading = file.name;
    this.overlays.showBusy(`Reading ${file.name} …`);
    try {
      await this.send!(file);
      this.overlays.hush();
    } catch (error) {
      this.overlays.say(error instanceof Error ? error.message : String(error));
    } finally {
      this.reading = null;
      this.overlays.showBusy(null);
    }
  }
}
