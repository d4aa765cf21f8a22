// Bundles src/ into the one file dist/page.html: no request to anywhere, the same bytes on every machine.
//   node build.mjs [OUT]
import { mkdir, readdir, readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = path.dirname(fileURLToPath(import.meta.url));
const out = path.resolve(process.argv[2] ?? path.join(here, "dist", "page.html"));

/** The text of one bundled entry; the licences stand in a comment of the page. */
async function bundle(entry) {
  const result = await build({
    entryPoints: [path.join(here, "src", entry)],
    absWorkingDir: here,
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: "es2022",
    charset: "utf8",
    legalComments: "none",
  });
  return result.outputFiles[0].text.trim();
}

/** The notice that the licences ask for, since a page is passed on alone. */
async function notice(...names) {
  const texts = await Promise.all(
    names.map(async (name) => {
      const folder = path.join(here, "node_modules", name);
      const file = (await readdir(folder)).find((entry) => /^licen[sc]e/i.test(entry));
      return readFile(path.join(folder, file), "utf8");
    }),
  );
  const owners = names.map((name, i) => `${name}: ${/^Copyright.*$/m.exec(texts[i])[0]}`);
  const permission = texts[0].slice(texts[0].indexOf("Permission is hereby granted")).trim();
  return `This page contains, under the MIT licence:\n${owners.join("\n")}\n\n${permission}`;
}

/** The line that the program replaces to say where the page's data come from; see docs/view_protocol.md. */
const source = '<script id="source" type="application/json">{"kind": "live"}</script>';
const template = (await readFile(path.join(here, "src", "page.html"), "utf8"))
  .replace(/<script id="source"[\s\S]*?<\/script>/, source)
  .replace(/^\s+/gm, "");
const parts = {
  notice: await notice("three", "lil-gui", "uplot"),
  style: await bundle("page.css"),
  // A script ends at the first "</script" of the page, wherever it stands.
  program: (await bundle("main.ts")).replaceAll("</script", "<\\/script"),
  worker: (await bundle("play_worker.ts")).replaceAll("</script", "<\\/script"), // worker of a page that carries its scene
};
const page = template.replace(/\s*\/\*\{(\w+)\}\*\/\s*/g, (_, name) => parts[name]);
for (const once of [source, '<script id="program">'])
  if (page.split(once).length !== 2) throw new Error(`The page must contain ${once} once.`);
await mkdir(path.dirname(out), { recursive: true });
await writeFile(out, page);
console.log(`${out}: ${page.length} characters`);
