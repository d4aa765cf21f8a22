/** Starts the page that its source asks for: a live scene, a result folder, or what is in the page itself. */

import { nullable, object, word } from "./decode";
import { element } from "./dom";
import { LiveApp } from "./live_app";
import { readRecording, RecordedValues } from "./recording";
import { readReport } from "./report";
import { ResultsApp } from "./results_app";

const token = new URLSearchParams(location.search).get("token") ?? "";
const textOf = (id: string) => document.getElementById(id)?.textContent ?? "";

async function fetched(path: string): Promise<Response> {
  const answer = await fetch(`${path}?${new URLSearchParams({ token })}`);
  if (!answer.ok) throw new Error(`${path}: ${(await answer.text()).trim() || answer.status}`);
  return answer;
}

function bytesOfBase64(text: string): ArrayBuffer {
  const binary = atob(text.trim());
  return Uint8Array.from(binary, (letter) => letter.charCodeAt(0)).buffer;
}

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
    new ResultsApp(new RecordedValues(recording), nullable(readReport)(report, "report"));
    words.remove();
  } catch (error) {
    words.textContent = `The results cannot be shown. ${error instanceof Error ? error.message : String(error)}`;
  }
}

const readSource = object({ kind: word("live", "recorded", "embedded") });
const { kind } = readSource(JSON.parse(textOf("source")), "source");
if (kind === "live") new LiveApp(token);
else void startResults(kind === "embedded");
