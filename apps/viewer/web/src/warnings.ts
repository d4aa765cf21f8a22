/** Warnings of a scene: short; one that several bodies share is shown once. */

import { element } from "./dom";

const NAME = /"[^"]*"/;
const PERCENT = /\d[\d.]* %/;

/** Lines that differ in the name of a body and in a percentage alone become one: "a", "b" ... of 5 to 23 %. */
export function grouped(warnings: string[]): string[] {
  const groups = new Map<string, string[]>();
  for (const text of warnings.map(short)) {
    const pattern = text.replace(NAME, '"*"').replace(PERCENT, "* %");
    groups.set(pattern, [...(groups.get(pattern) ?? []), text]);
  }
  return [...groups.values()].map(([first, ...others]) => {
    if (others.length === 0 || others.every((text) => text === first)) return first;
    const all = [first, ...others];
    const names = all.map((text) => NAME.exec(text)?.[0] ?? "").filter((name) => name !== "");
    const shares = all.map((text) => parseFloat(PERCENT.exec(text)?.[0] ?? "NaN")).filter(Number.isFinite);
    const [least, greatest] = [Math.min(...shares), Math.max(...shares)];
    const range = least < greatest ? `${least} to ${greatest} %` : `${greatest} %`;
    const many = names.length > 3 ? `${names.slice(0, 2).join(", ")} and ${names.length - 2} others` : names.join(", ");
    return first
      .replace(NAME, () => many)
      .replace(PERCENT, () => range)
      .replace(" has an ", " have an ");
  });
}

/** Without the folder of the file that it is about. */
const short = (text: string) => text.replace(/^\S*\/(?=[^/\s]+:\s)/, "");

/** A list below the title; on telephones it opens when its line is touched. */
export class Warnings {
  readonly root = element("details", { class: "warnings", data: "warnings", hidden: true });
  private readonly summary = element("summary", {});
  private readonly list = element("ul", {});

  constructor() {
    this.root.append(this.summary, this.list);
  }

  set(warnings: string[]): void {
    const lines = grouped(warnings);
    this.root.hidden = lines.length === 0;
    this.summary.textContent = lines.length === 1 ? "1 warning" : `${lines.length} warnings`;
    this.list.replaceChildren(...lines.map((line) => element("li", { title: line }, line)));
    this.root.open = !matchMedia("(max-width: 720px), (max-height: 520px)").matches;
  }
}
