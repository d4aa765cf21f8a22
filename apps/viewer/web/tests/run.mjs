// Bundles the tests beside this file and runs them, one after another, with node's own runner, in TAP.
//   node tests/run.mjs [NAME ...]     names without .test.ts; all beside this file when none is given
import { spawnSync } from "node:child_process";
import { readdirSync, rmSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = path.dirname(fileURLToPath(import.meta.url));
const web = path.dirname(here);
const bundle = path.join(web, `node_modules/.cache/tests-${process.pid}.mjs`); // there it finds playwright-core
const wanted = process.argv.slice(2);
const names =
  wanted.length > 0
    ? wanted.map((name) => `${name}.test.ts`)
    : readdirSync(here).filter((name) => name.endsWith(".test.ts"));
await build({
  stdin: { contents: names.map((name) => `import "./${name}";`).join("\n"), resolveDir: here },
  outfile: bundle,
  bundle: true,
  platform: "node",
  format: "esm",
  target: "node18",
  external: ["playwright-core"],
  logLevel: "error",
});
const run = spawnSync(process.execPath, ["--test-reporter=tap", bundle], { stdio: "inherit", cwd: web });
rmSync(bundle);
process.exit(run.status ?? 1);
