/** Overlays of the scene: the keyboard help, the lost connection, one line that passes. */

import { element, setText } from "./dom";

export class Overlays {
  readonly root = element("div", { class: "overlays" });
  private readonly lost = element("div", { class: "veil", data: "lost", role: "alert", hidden: true });
  private readonly lostWords = element("p", {});
  private readonly help: HTMLElement;
  private readonly closeButton: HTMLButtonElement;
  private focusBefore: Element | null = null; // where the keys went before the help
  private readonly keys = element("table", {});
  private readonly toast = element("div", { class: "toast", data: "toast", role: "alert", hidden: true });
  private toastEnds = 0;
  private readonly invitation = element("div", { class: "invitation", data: "invitation", hidden: true });
  private readonly busy = element("div", { class: "busy card", data: "busy", role: "status", hidden: true });
  private readonly busyWords = element("span", {});

  constructor(keys: [string, string][]) {
    this.lost.append(element("div", { class: "card dialog" }, element("span", { class: "spinner" }), this.lostWords));
    this.setKeys(keys);
    this.closeButton = element("button", { type: "button", on: { click: () => this.showHelp(false) } }, "Close");
    this.help = element(
      "div",
      {
        class: "veil",
        data: "help",
        hidden: true,
        role: "dialog",
        "aria-modal": "true",
        "aria-label": "Mouse and keys",
        on: {
          click: (event: MouseEvent) => event.target === this.help && this.showHelp(false),
          keydown: (event: KeyboardEvent) => this.keepFocus(event),
        },
      },
      element("div", { class: "card dialog" }, element("h2", {}, "Mouse and keys"), this.keys, this.closeButton),
    );
    this.invitation.append(element("p", { class: "card" }, "Drop a mesh or a surface here to open it"));
    this.busy.append(element("span", { class: "spinner" }), this.busyWords);
    this.root.append(this.lost, this.help, this.invitation, this.busy, this.toast);
  }

  /** Sets the entries of the help: a key or a gesture, and its effect. */
  setKeys(keys: [string, string][]): void {
    this.keys.replaceChildren(
      ...keys.map(([key, what]) =>
        element("tr", {}, element("th", {}, element("kbd", {}, key)), element("td", {}, what)),
      ),
    );
  }

  /** A file is being dragged over the page. */
  invite(isInvited: boolean): void {
    this.invitation.hidden = !isInvited;
  }

  /** Shows work that is under way beside the scene; null: nothing. */
  showBusy(words: string | null): void {
    this.busy.hidden = words === null;
    setText(this.busyWords, words ?? "");
  }

  showLost(words: string | null): void {
    this.lost.hidden = words === null;
    if (words !== null) setText(this.lostWords, words);
  }

  /** The dialog has the keys while it is open, and gives them back to who had them. */
  showHelp(visible: boolean): void {
    if (visible === this.helpIsOpen) return;
    if (visible) this.focusBefore = document.activeElement;
    this.help.hidden = !visible;
    if (visible) this.closeButton.focus();
    else if (this.focusBefore instanceof HTMLElement) this.focusBefore.focus({ preventScroll: true });
  }

  /** The button is all that can have the focus in the dialog. */
  private keepFocus(event: KeyboardEvent): void {
    if (event.key === "Tab") event.preventDefault();
    if (event.key !== "Escape" && event.key !== "?") return;
    event.stopPropagation();
    this.showHelp(false);
  }

  get helpIsOpen(): boolean {
    return !this.help.hidden;
  }

  /** One line for as long as it takes to read it. */
  say(text: string, mood: "refused" | "fine" = "refused"): void {
    setText(this.toast, text);
    this.toast.dataset.mood = mood;
    this.toast.hidden = false;
    clearTimeout(this.toastEnds);
    this.toastEnds = window.setTimeout(() => (this.toast.hidden = true), Math.max(6000, 70 * text.length));
  }

  /** Takes the line away. */
  hush(): void {
    clearTimeout(this.toastEnds);
    this.toast.hidden = true;
  }
}
