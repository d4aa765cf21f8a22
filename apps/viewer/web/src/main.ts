/** Starts the page that its source asks for. */

import { LiveApp } from "./live_app";

const source = JSON.parse(document.getElementById("source")!.textContent!) as { kind: string };
const token = new URLSearchParams(location.search).get("token") ?? "";
if (source.kind === "live") new LiveApp(token);
