/** Modal analysis of a recorded run: eigenfrequencies, and the tone of each mode. */

import type { RecordedFrame } from "./recording";
import type { Report } from "./report";
import { withUnit } from "./numbers";

export interface Mode {
  number: number;
  frequency: number; // [Hz]
  isRigid: boolean;
  isUnstable: boolean;
}

/** By place in the recording's frames; null: the frame shows no vibration. Empty: the run is about something else. */
export function modesOf(frames: RecordedFrame[], report: Report | null): (Mode | null)[] {
  const modes = frames.map(({ number }) => {
    const mode = report?.frames[number]?.mode;
    if (!mode) return null;
    const { frequency, rigid = false, unstable = false } = mode;
    return { number: mode.number, frequency, isRigid: rigid, isUnstable: unstable };
  });
  return modes.some((mode) => mode !== null) ? modes : [];
}

/** "mode 7 of 12 · 523 Hz". */
export function modeWords(mode: Mode | null, count: number): string {
  if (!mode) return "reference configuration";
  const words = mode.isUnstable ? "unstable" : mode.isRigid ? "rigid-body mode" : withUnit(mode.frequency, "Hz", 4);
  return `mode ${mode.number} of ${count} · ${words}`;
}

export const SWING = 1; // [Hz] at which shapes swing on the page

/** How far a shape has swung at a time of playing [s]: from 1, its whole. */
export const swingAt = (clock: number) => Math.cos(2 * Math.PI * SWING * clock);

const [LOWEST, HIGHEST] = [20, 20_000]; // [Hz] that people hear
const FADE = 0.05; // [s]

/** The tone of a mode, where it can be heard. */
export class Tone {
  private context: AudioContext | null = null;
  private oscillator: OscillatorNode | null = null;
  private gain: GainNode | null = null;
  frequency: number | null = null; // [Hz] that sounds; null: silence

  static canBeHeard(mode: Mode | null): boolean {
    return mode !== null && mode.frequency >= LOWEST && mode.frequency <= HIGHEST;
  }

  /** Null: silence. */
  play(mode: Mode | null): void {
    this.frequency = mode && Tone.canBeHeard(mode) ? mode.frequency : null;
    if (this.frequency === null) return this.fade(0);
    if (!this.context) {
      this.context = new AudioContext();
      this.gain = this.context.createGain();
      this.gain.gain.value = 0;
      this.oscillator = this.context.createOscillator();
      this.oscillator.connect(this.gain).connect(this.context.destination);
      this.oscillator.start();
    }
    this.oscillator!.frequency.setTargetAtTime(this.frequency, this.context.currentTime, FADE);
    this.fade(0.2);
  }

  private fade(loudness: number): void {
    if (this.context) this.gain!.gain.setTargetAtTime(loudness, this.context.currentTime, FADE);
  }
}
