// The real page in a real browser on the real program; leaves a screenshot as an artefact.
// Run: REND_BINARY=build/release/rend REND_ROOT=. node tests/end_to_end/page.mjs FOLDER_FOR_SCREENSHOTS
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { RendServer } from "./server.mjs";

const page_tests = join(dirname(fileURLToPath(import.meta.url)), "../page");
// The default scene, but so long that no browser is slow enough to find it finished.
const folder = await mkdtemp(join(tmpdir(), "rend-page-"));
const scene = JSON.parse(await readFile(join(process.env.REND_ROOT, "scenes/tear.json"), "utf8"));
delete scene.$schema;
await writeFile(join(folder, "tear.json"), JSON.stringify({ ...scene, frames: 2000 }));
const server = await RendServer.start(process.env.REND_BINARY, process.env.REND_ROOT, join(folder, "tear.json"));
const tests = spawn(process.execPath, ["run.mjs", process.argv[2] ?? "."], {
  cwd: page_tests,
  env: { ...process.env, REND_URL: server.url },
  stdio: "inherit",
});
const [status, signal] = await once(tests, "exit");
const ended = await server.stop();
await rm(folder, { recursive: true });
if (ended.code !== 0) console.error(`the server ended with ${ended.code}: ${server.log}`);
if (signal) console.error(`the tests were ended by ${signal}`);
process.exit(status || (signal || ended.code !== 0 ? 1 : 0));
