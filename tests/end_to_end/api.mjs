// The real program over HTTP: the first picture in time, transport, steering, errors, a clean end.
// Run: REND_BINARY=build/release/rend REND_ROOT=. node --test tests/end_to_end/api.mjs
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { after, before, test } from "node:test";
import { RendServer, patience } from "./server.mjs";

const binary = process.env.REND_BINARY;
const root = process.env.REND_ROOT;
const threshold = "/materials/clay/yield_surface/tau_c";
let low;
let server;

before(async () => {
  server = await RendServer.start(binary, root);
});
after(async () => {
  await server?.stop();
});

test("the first picture of the default scene is there within 10 s of the start", async () => {
  const begun = performance.now();
  let picture;
  do picture = await server.get("/api/frame.jpg?wait=1000&w=640&h=360");
  while (picture.status === 204);
  const seconds = server.startSeconds + (performance.now() - begun) / 1000;
  assert.equal(picture.status, 200);
  const bytes = new Uint8Array(picture.body);
  assert.deepEqual([...bytes.slice(0, 2)], [0xff, 0xd8]);
  assert.ok(bytes.length > 5000, `only ${bytes.length} bytes`);
  assert.ok(seconds < 10 * patience, `took ${seconds} s`);
  console.log(`first picture after ${seconds.toFixed(2)} s`);
});

test("play advances frames, pause stops them, step makes one", async () => {
  await server.send("POST", "/api/actions/play");
  await server.until((s) => s.frame >= 3);
  await server.send("POST", "/api/actions/pause");
  const paused = await server.until((s) => s.status === "paused");
  await new Promise((wake) => setTimeout(wake, 500));
  assert.equal((await server.get("/api/state")).body.frame, paused.frame);
  await server.send("POST", "/api/actions/step", { frames: 1 });
  const stepped = await server.until((s) => s.frame > paused.frame);
  assert.equal(stepped.frame, paused.frame + 1);
});

test("every recorded frame comes as PNG and as a mesh in every format", async () => {
  const png = await server.get("/api/frames/1.png?w=320&h=180");
  assert.equal(Buffer.from(png.body).subarray(1, 4).toString(), "PNG");
  const ply = await server.get("/api/frames/1/mesh.ply");
  assert.ok(Buffer.from(ply.body).subarray(0, 200).toString().startsWith("ply\nformat binary_little_endian"));
  for (const [format, start] of [["vtp", "<?xml"], ["obj", "# rend"], ["glb", "glTF"]]) {
    const mesh = await server.get(`/api/frames/1/mesh.${format}`);
    assert.ok(Buffer.from(mesh.body).toString("latin1").startsWith(start), format);
  }
  assert.equal((await server.get("/api/frames/1/mesh.stl")).status, 404);
  assert.equal((await server.get("/api/frames/99999.png")).status, 404);
});

test("bad requests are refused with a problem that names the place", async () => {
  const range = await server.send("PATCH", "/api/parameters", { values: { [threshold]: -1 } });
  assert.equal(range.status, 422);
  assert.equal(range.body.pointer, `/values/${threshold}`);
  const step = "/api/actions/step";
  const pull = { at: [0, 0, 0], force: [0, 0, 1], radius: 0.1 };
  const bad = [
    ["PATCH", "/api/parameters", "{", undefined],
    ["PATCH", "/api/parameters", { values: { [threshold]: true } }, `/values/${threshold}`],
    ["PATCH", "/api/parameters", `{"values": {"${threshold}": 1e999}}`, undefined],
    ["POST", "/api/scene", { name: "../../etc/passwd" }, "/name"],
    ["POST", "/api/scene", { name: 7 }, "/name"],
    ["POST", "/api/scene", { name: "tear", nmae: "press" }, "/nmae"],
    ["POST", "/api/scene", '{"name": "tear", "name": "press"}', "/name"],
    ["POST", "/api/scene", '{"name": NaN}', undefined],
    ["POST", "/api/scene", "[".repeat(4000), "/0".repeat(32)],
    ["POST", step, { frames: 0 }, "/frames"],
    ["POST", step, { frames: 1.5 }, "/frames"],
    ["POST", step, { frames: "2" }, "/frames"],
    ["POST", step, '{"frames": 1e30}', "/frames"],
    ["POST", step, { frmaes: 2 }, "/frmaes"],
    ["POST", "/api/actions/play", { frames: 2 }, "/frames"],
    ["POST", "/api/pull", { ...pull, at: [0, 0, null] }, "/at"],
    ["POST", "/api/pull", { ...pull, at: [0, 0] }, "/at"],
    ["POST", "/api/pull", { ...pull, force: [0, 1e300, 0] }, "/force"],
    ["POST", "/api/pull", { ...pull, radius: -1 }, "/radius"],
  ];
  const before = (await server.get("/api/state")).body;
  for (const [method, path, body, pointer] of bad) {
    const reply = await server.send(method, path, body);
    const sent = `${path} ${JSON.stringify(body).slice(0, 80)}`;
    assert.equal(reply.status, 422, sent);
    assert.equal(reply.body.pointer, pointer, sent);
    assert.ok(reply.body.detail.length > 5 && reply.body.detail.length < 400);
  }
  const after = (await server.get("/api/state")).body;
  assert.equal(after.frame, before.frame);
  assert.equal(after.scene, before.scene);
  assert.equal((await server.send("POST", "/api/actions/explode")).status, 404);
  assert.equal((await server.get("/api/frame.jpg?w=100000")).status, 422);
  assert.equal((await server.get("/api/nothing")).status, 404);
});

test("a spring pulls at what a probe finds, and is refused without a grip to move or with bad numbers", async () => {
  await server.send("POST", "/api/actions/reset");
  await server.until((s) => s.frame === 0 && s.status !== "preparing");
  await server.send("POST", "/api/actions/pause");
  const { body: look } = await server.get("/api/probe?x=0.4&y=0.5&w=640&h=360");
  assert.ok(look.matter, "there is matter in the middle");
  assert.equal(look.matter.material, "clay");
  assert.equal((await server.get("/api/probe?x=0.01&y=0.01&w=640&h=360")).body.matter, null);
  assert.equal((await server.get("/api/probe?x=2&y=0.5")).status, 422);
  assert.equal((await server.get("/api/probe?y=0.5")).status, 422);
  const { grip } = (await server.get("/api/state")).body;
  const at = look.matter.position;
  const target = [at[0], at[1] + 0.3, at[2]];
  const bad = await server.send("POST", "/api/pull", { at, target, radius: grip.radius, strength: -1 });
  assert.equal(bad.status, 422);
  assert.equal(bad.body.pointer, "/strength");
  const pull = await server.send("POST", "/api/pull", { at, target, ...grip });
  assert.equal(pull.status, 200);
  // The server lets go of a spring that nobody speaks of for 5 s, and frames may take longer.
  const reminder = setInterval(() => server.send("POST", "/api/pull", { target, ...grip }), 1000);
  const pulls = (s) => s.frame >= 2 && s.pull && Math.hypot(...s.pull.force) > 0;
  const held = await server.until(pulls).finally(() => clearInterval(reminder));
  assert.equal(held.status, "playing");
  assert.ok(held.pull.at[1] > at[1], "the grip goes up with the matter");
  await server.send("POST", "/api/pull", { radius: 0 });
  await server.until((s) => s.pull === null);
  await server.send("POST", "/api/actions/pause");
});

test("an uploaded mesh becomes a scene that runs; a bad one is refused and leaves the run alone", async () => {
  const upload = async (name, text) => {
    const response = await fetch(`${server.url}/api/meshes?name=${encodeURIComponent(name)}`, {
      method: "POST",
      headers: { "Content-Type": "application/octet-stream" },
      body: text,
    });
    return { status: response.status, body: await response.json() };
  };
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => `v ${i & 1 ? 3 : 0} ${(i >> 1) & 1} ${i >> 2}`);
  const box = [...corners, "f 1 3 4 2", "f 5 6 8 7", "f 1 2 6 5", "f 3 7 8 4", "f 1 5 7 3", "f 2 4 8 6"].join("\n");
  const refused = await upload("broken.obj", "v 0 0 0\nf 1 1 1\n");
  assert.equal(refused.status, 422);
  assert.match(refused.body.detail, /broken\.obj/);
  assert.equal((await upload("virus.exe", "MZ")).status, 422);
  assert.equal((await server.get("/api/state")).body.scene, "tear");
  const { status, body } = await upload("my brick.obj", box);
  assert.equal(status, 200);
  assert.equal(body.name, "my_brick");
  const { scenes } = (await server.get("/api/scenes")).body;
  assert.equal(scenes[0].name, "my_brick");
  assert.equal((await server.send("POST", "/api/scene", { name: "my_brick" })).status, 200);
  await server.until((s) => s.scene === "my_brick" && s.status === "paused");
  await server.send("POST", "/api/actions/step", { frames: 1 });
  const stepped = await server.until((s) => s.frame === 1);
  assert.ok(stepped.particles > 10000 && stepped.particles < 50000, `${stepped.particles} particles`);
  await server.send("POST", "/api/scene", { name: "tear" });
  await server.until((s) => s.scene === "tear" && s.status === "paused");
});

const ended = (s) => s.status === "finished" || s.status === "stopped";
/// Plays to the end; a slow build pauses where it has shown `enough`.
async function play_until(enough) {
  await server.send("POST", "/api/actions/play");
  const last = await server.until((s) => ended(s) || (patience > 1 && enough(s)), 400);
  if (patience === 1) assert.equal(last.status, "finished", last.message);
  if (ended(last)) return last;
  await server.send("POST", "/api/actions/pause");
  return server.until((s) => s.status === "paused" || ended(s));
}

test("with its own threshold the bar tears, with a high one it holds", { timeout: 900_000 * patience }, async () => {
  const torn = await play_until((s) => s.pieces >= 2);
  assert.ok(torn.pieces >= 2, `${torn.pieces} pieces, ${torn.status} ${torn.message}`);
  const { parameters } = (await server.get("/api/parameters")).body;
  const high = parameters.find((p) => p.id === threshold).max;
  low = parameters.find((p) => p.id === threshold).default;
  await server.send("POST", "/api/actions/reset");
  await server.until((s) => s.frame === 0);
  await server.send("POST", "/api/actions/play");
  const changed = await server.send("PATCH", "/api/parameters", { values: { [threshold]: high } });
  assert.equal(changed.status, 200);
  const whole = await play_until((s) => s.frame >= torn.frame + 8);
  assert.notEqual(whole.status, "stopped", whole.message);
  assert.equal(whole.pieces, 1);
});

test("recorded frames are meshed again with other settings, and show what is close to breaking", async () => {
  await server.send("PATCH", "/api/parameters", { values: { [threshold]: low } });
  await server.send("POST", "/api/actions/reset");
  await server.until((s) => s.frame === 0);
  const torn = await play_until((s) => s.pieces >= 2);
  assert.ok(torn.broken_edges > 0);
  const frame = torn.frame - (patience > 1 ? 1 : 5);
  const picture = (color) => server.get(`/api/frame.jpg?w=320&h=200&frame=${frame}&color=${color}`);
  const before = await picture("threshold");
  assert.match(before.headers.get("x-legend"), /^0;1;Share of break threshold$/);
  const mesh = async () => Buffer.from((await server.get(`/api/frames/${frame}/mesh.ply`)).body);
  const first = await mesh();
  assert.equal((await server.send("PATCH", "/api/parameters", { values: { "/fracture/gap": 1.9 } })).status, 200);
  const after = await server.until((s) => s.broken_edges < torn.broken_edges);
  assert.equal(after.frame, torn.frame, "nothing was simulated again");
  assert.equal(after.status, torn.status);
  assert.ok(!first.equals(await mesh()), "frames before the last are meshed again too");
  const renewed = await picture("threshold");
  assert.notEqual(renewed.headers.get("x-token"), before.headers.get("x-token"));
});

/// What becomes of an export.
async function export_end(id) {
  const deadline = Date.now() + 120_000 * patience;
  while (Date.now() < deadline) {
    const { body } = await server.get(`/api/exports/${id}`);
    if (body.status !== "running") return body;
    await new Promise((wake) => setTimeout(wake, 50));
  }
  throw new Error("the export does not end");
}

test("an export is one archive with the pictures, or the meshes, of the frames asked for", async () => {
  const run_export = async (order, view = "") => {
    const started = await server.send("POST", `/api/exports${view}`, order);
    assert.equal(started.status, 200, JSON.stringify(started.body));
    const job = await export_end(started.body.id);
    assert.equal(job.status, "done", job.reason);
    const file = await server.get(`/api/exports/${job.id}/file`);
    assert.equal(file.body.byteLength, job.bytes);
    assert.equal(file.headers.get("content-disposition"), `attachment; filename="${job.name}.zip"`);
    return { job, bytes: Buffer.from(file.body) };
  };
  /// Names and sizes from the directory at the end of an archive.
  const directory = (zip) => {
    const files = {};
    let at = zip.readUInt32LE(zip.lastIndexOf("PK\x05\x06", undefined, "latin1") + 16);
    while (zip.toString("latin1", at, at + 4) === "PK\x01\x02") {
      const [name, extra, comment] = [28, 30, 32].map((offset) => zip.readUInt16LE(at + offset));
      files[zip.toString("utf8", at + 46, at + 46 + name)] = zip.readUInt32LE(at + 24);
      at += 46 + name + extra + comment;
    }
    return files;
  };
  const { frame } = (await server.get("/api/state")).body;
  const all = await run_export({ format: "png" }, "?w=96&h=54");
  const names = Object.keys(directory(all.bytes));
  assert.equal(names.length, frame + 2, "frames 0 to the newest, and the table");
  assert.ok(names.includes("tear-png/png/000000.png") && names.includes("tear-png/frames.csv"));
  const png = all.bytes.indexOf("\x89PNG\r\n\x1a\n", 0, "latin1");
  assert.deepEqual([all.bytes.readUInt32BE(png + 16), all.bytes.readUInt32BE(png + 20)], [96, 54]);
  const some = directory((await run_export({ format: "vtp", first: 1, last: 2 })).bytes);
  for (const name of ["mesh/000001.vtp", "mesh/000002.vtp", "particles/000002.vtp", "mesh.pvd", "frames.csv"])
    assert.ok(some[`tear-vtp/${name}`] > 100, name);
  assert.equal(Object.keys(some).length, 7);
  assert.equal((await server.get(`/api/exports/${all.job.id}`)).status, 404, "the last one only");
  assert.equal((await server.get("/api/exports")).body.running, null);
  const head = await fetch(`${server.url}/api/exports/${all.job.id + 1}/file`, { method: "HEAD" });
  assert.ok(Number(head.headers.get("content-length")) > 1000);
  for (const [order, pointer] of [
    [{ format: "gif" }, "/format"],
    [{}, "/format"],
    [{ format: "png", first: 5, last: 2 }, "/last"],
    [{ format: "png", first: 0.5 }, "/first"],
    [{ format: "png", first: 100000 }, "/first"],
    [{ format: "png", folder: "/etc" }, "/folder"],
  ]) {
    const refused = await server.send("POST", "/api/exports", order);
    assert.equal(refused.status, 422, JSON.stringify(order));
    assert.equal(refused.body.pointer, pointer, JSON.stringify(order));
  }
  const { id } = (await server.send("POST", "/api/exports?w=1600&h=900", { format: "png" })).body;
  const second = await server.send("POST", "/api/exports", { format: "png" });
  assert.equal(second.status, 409);
  assert.equal((await server.get("/api/exports")).body.running.id, id);
  assert.equal((await server.send("DELETE", `/api/exports/${id}`)).status, 200);
  assert.equal((await export_end(id)).status, "cancelled");
  assert.equal((await server.get(`/api/exports/${id}/file`)).status, 404);
});

test("a port that is taken is told, with exit code 2", async () => {
  const second = spawn(binary, ["serve", "tear", "--port", new URL(server.url).port], {
    env: { ...process.env, REND_ROOT: root },
    stdio: ["ignore", "ignore", "pipe"],
  });
  let said = "";
  second.stderr.on("data", (data) => (said += data));
  const [code] = await once(second, "close");
  assert.equal(code, 2);
  assert.match(said, /is taken by another program; choose another/);
});

test("SIGTERM ends the server within 2 s, also while it exports large pictures", async () => {
  const { status } = await server.send("POST", "/api/exports?w=3840&h=2160", { format: "png" });
  assert.equal(status, 200);
  const { code, seconds } = await server.stop();
  assert.equal(code, 0);
  assert.ok(seconds < 2 * patience, `took ${seconds} s`);
});
