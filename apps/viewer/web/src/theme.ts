/** Light, dark, or as the system says. */

export type ThemeChoice = "auto" | "light" | "dark";

export class Theme {
  choice: ThemeChoice = "auto";
  private readonly system = matchMedia("(prefers-color-scheme: dark)");

  constructor(private readonly changed: (dark: boolean) => void) {
    this.system.addEventListener("change", () => this.apply());
  }

  get dark(): boolean {
    return this.choice === "auto" ? this.system.matches : this.choice === "dark";
  }

  choose(choice: ThemeChoice): void {
    this.choice = choice;
    this.apply();
  }

  apply(): void {
    document.documentElement.dataset.theme = this.dark ? "dark" : "light";
    known.clear();
    this.changed(this.dark);
  }
}

/** Values that have been asked for since the theme changed: curves ask for them with each point. */
const known = new Map<string, string>();

/** The value of a custom property of style.css. */
export function styleValue(name: string): string {
  let value = known.get(name);
  if (value === undefined) {
    value = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    known.set(name, value);
  }
  return value;
}
