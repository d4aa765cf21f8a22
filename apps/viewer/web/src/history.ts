/** Undo: the messages that take back actions on the page, the last action first. */

import type { PageMessage } from "./protocol";

const MOST = 100; // deeds

export class History {
  private readonly back: { what: string; messages: () => PageMessage[] }[] = [];

  /** `what`: in words, after "Undid: ". */
  add(what: string, ...messages: PageMessage[]): void {
    this.addLater(what, () => messages);
  }

  /** The same with messages that are made when the action is taken back. */
  addLater(what: string, messages: () => PageMessage[]): void {
    this.back.push({ what, messages });
    if (this.back.length > MOST) this.back.shift();
  }

  take(): { what: string; messages: PageMessage[] } | null {
    const last = this.back.pop();
    return last ? { what: last.what, messages: last.messages() } : null;
  }

  clear(): void {
    this.back.length = 0;
  }

  get length(): number {
    return this.back.length;
  }
}
