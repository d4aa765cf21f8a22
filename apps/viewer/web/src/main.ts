/** Starts the page that its source asks for: a live scene, a result folder, or what is in the page itself. */

import { list, nullable, object, text, word } from "./decode";
import { element } from "./dom";
import { LiveApp } from "./live_app";
import { readAddress } from "./address";
import { readField } from "./protocol";
import { type OtherFields, RecordedValues } from "./recorded_values";
import { inflated, readRecording } from "./recording";
import { readReport } from "./report";
import { ResultsApp } from "./results_app";
import { readTakingUp, type TakingUp, wordsOfStart } from "./taking_up";
import { carried, hosted, served } from "./transport";

const token = new URLSearchParams(location.search).get("token") ?? "";
const textOf = (id: string) => document.getElementById(id)?.textContent ?? "";

async function fetched(path: string, more: Record<string, string> = {}): Promise<Response> {
  const answer = await fetch(`${path}?${new URLSearchParams({ token, ...more })}`);
  if (!answer.ok) throw new Error(`${path}: ${(await answer.text()).trim() || answer.status}`);
  return answer;
}

function bytesOfBase64(text: string): ArrayBuffer {
  const binary = atob(text.trim());
  return Uint8Array.from(binary, (letter) => letter.charCodeAt(0)).buffer;
}

/** Fields that the recording does not hold: the program computes them, or a small page has them with it. */
async function otherFields(embedded: boolean): Promise<OtherFields> {
  if (!embedded) {
    const answer = await fetched("fields").catch(() => null); // without them the recording can be shown all the same
    return {
      fields: answer === null ? [] : list(readField)(await answer.json(), "fields"),
      fetch: async (name) => (await fetched("field", { name })).arrayBuffer(),
    };
  }
  const entries = list(readEmbeddedField)(JSON.parse(textOf("fields") || "[]"), "fields");
  const values = new Map(entries.map((entry) => [entry.field.name, entry.values]));
  return {
    fields: entries.map((entry) => entry.field),
    fetch: async (name) => {
      const bytes = await inflated(new Uint8Array(bytesOfBase64(values.get(name)!)));
      return bytes.buffer as ArrayBuffer;
    },
  };
}

const readEmbeddedField = object({ field: readField, values: text });

async function startResults(embedded: boolean): Promise<void> {
  const words = element("p", { class: "reading", data: "reading", role: "status" }, "Reading the recording …");
  document.body.append(words);
  try {
    const buffer = embedded ? bytesOfBase64(textOf("recording")) : await (await fetched("recording")).arrayBuffer();
    const recording = await readRecording(
      buffer,
      (share) => (words.textContent = `Reading the recording: ${Math.round(100 * share)} %`),
    );
    if (recording.frames.length === 0) throw new Error(recording.damage || "The recording holds no frame.");
    const report: unknown = JSON.parse(embedded ? textOf("report") || "null" : await (await fetched("report")).text());
    const values = new RecordedValues(recording, await otherFields(embedded));
    new ResultsApp(values, nullable(readReport)(report, "report"), takingUp);
    words.remove();
  } catch (error) {
    words.textContent = `The results cannot be shown. ${error instanceof Error ? error.message : String(error)}`;
  }
}

const unpacked = (id: string) => inflated(new Uint8Array(bytesOfBase64(textOf(id))));

/** A scene that the page has with it, and what simulates it; `from`: the number of the recorded frame it begins at. */
async function startPlaying(from?: number): Promise<void> {
  const words = element("p", { class: "reading", data: "reading", role: "status" }, "Reading the scene …");
  document.body.append(words);
  try {
    const warnings = list(text)(JSON.parse(textOf("warnings") || "[]"), "warnings");
    const start = from === undefined ? null : await unpacked(`state-${from}`);
    const game = { engine: await unpacked("engine"), scene: await unpacked("scene"), warnings, start };
    new LiveApp(carried(textOf("worker"), game), from === undefined ? null : wordsOfStart(takingUp!, from));
    words.remove();
  } catch (error) {
    words.textContent = `The scene cannot be simulated. ${error instanceof Error ? error.message : String(error)}`;
  }
}

const readSource = object({ kind: word("live", "recorded", "embedded", "playable", "hosted") });
const { kind } = readSource(JSON.parse(textOf("source")), "source");
const takingUp: TakingUp | null = nullable(readTakingUp)(JSON.parse(textOf("taking_up") || "null"), "taking_up");
const { from } = readAddress(location.hash);
if (kind === "live") new LiveApp(served(token));
else if (kind === "hosted") new LiveApp(hosted());
else if (kind === "playable") void startPlaying();
else if (takingUp?.frames.some(({ number }) => number === from)) void startPlaying(from);
else void startResults(kind === "embedded");
