/** A recording that carries its solver: the frames from which its scene can be played with. */

import { list, number, object, text, type Read } from "./decode";

/** Frames that the page can go on from; the state of each stands in a script of its own. */
export const readTakingUp = object({
  frames: list(object({ number, words: text })), // `words`: what the clock or the load is there
  notes: list(text), // differences between the played and the recorded scene
});
export type TakingUp = Read<typeof readTakingUp>;

/** Where a scene begins that was taken up, in words. */
export interface WordsOfStart {
  from: number; // number of the recorded frame
  heading: string;
  notes: string[];
}

export function wordsOfStart({ frames, notes }: TakingUp, from: number): WordsOfStart {
  const { words } = frames.find((frame) => frame.number === from)!;
  return { from, heading: `continued from frame ${from}, ${words}`, notes };
}

/** Goes to another address of this page, which begins anew there; the way back is the browser's, too. */
export function goTo(hash: string): void {
  history.pushState(null, "", hash);
  location.reload();
}
