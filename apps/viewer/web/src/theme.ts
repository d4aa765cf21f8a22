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
    this.changed(this.dark);
  }
}

export function styleValue(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
