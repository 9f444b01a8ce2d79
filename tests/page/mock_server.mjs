// A server with the program's HTTP interface and an invented run, so that the page is tested on its own.
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { extname, join, normalize } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { draw, to_png } from "./fake_picture.mjs";

const PAGE = fileURLToPath(new URL("../../web/page/", import.meta.url));
const TYPES = { ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml" };
const CSP = "default-src 'self'; img-src 'self' blob: data:";

const SCENES = [
  ["tear", "Notched bar", "pulled apart, Rankine", 20480, {}],
  ["crush", "Crushed block", "pressed in a frame, von Mises", 20104, { half: .3, height: .2, depth: .2 }],
  ["bone", "Bone", "pulled apart", 31220, { half: .45, height: .12, depth: .12 }],
  ["twist", "Twisted bar", "turned by 270 degrees, Rankine", 24576, { half: .4, height: .09, depth: .09 }],
  ["sheet", "Torn sheet", "thin plate, notched", 60000, { half: .4, height: .24, depth: .03 }],
].map(([name, title, description, particles, shape]) => ({ name, title, description, particles, shape }));

const parameter = (group, id, label, unit, value, min, max, more = {}) =>
  ({ id, label, unit, value, default: value, min, max, scale: "linear", help: "", applies: "live", group, ...more });

const parameters = () => [
  parameter("Material", "tau_c", "Yield threshold", "Pa", 2e4, 2e3, 2e5,
    { scale: "log", hero: true, help: "Lower tears sooner." }),
  parameter("Material", "softening", "Softening", "Pa", 1e5, 0, 4e5, { help: "Threshold lost per unit of plastic stretch." }),
  parameter("Material", "youngs_modulus", "Young's modulus", "Pa", 1e5, 1e4, 1e7, { scale: "log", applies: "reset" }),
  parameter("Fracture", "stretch", "Stretch threshold", "×", 1.35, 1.05, 3, { applies: "postprocess" }),
  parameter("Fracture", "smoothing", "Smoothing", "passes", 5, 0, 20, { step: 1, applies: "postprocess" }),
  parameter("Solver", "cfl", "Courant number", "", .6, .05, 1, {}),
  parameter("Solver", "transfer", "Transfer", "", "apic", 0, 0, { choices: ["pic", "apic", "flip"], applies: "reset" }),
  parameter("View", "cutaway", "Cutaway", "%", 0, 0, 100, { step: 1 }),
];

/// One invented run: `frames` frames at 24 per second, one recorded every `frame_ms` while playing.
export class MockRun {
  constructor({ frames = 120, frame_ms = 70, most_width = 240 } = {}) {
    Object.assign(this, {
      frames, frame_ms, most_width, revision: 1, frame: 0, status: "paused", scene: "tear", reason: null, progress: null,
      uploads: [], patches: [], actions: [], frame_requests: [], patch_ms: 0,
      patches_in_flight: 0, most_patches_in_flight: 0, down: false,
    });
    this.parameters = parameters();
    this.waiting = new Set();
    this.timer = setInterval(() => { if (this.status === "playing") this.advance(); }, frame_ms);
  }

  changed() {
    this.revision++;
    for (const wake of this.waiting) wake();
    this.waiting.clear();
  }

  /// Resolves at the next change, or after `ms`.
  change_within(ms) {
    return new Promise((resolve) => {
      const timer = setTimeout(resolve, ms);
      this.waiting.add(() => { clearTimeout(timer); resolve(); });
    });
  }

  advance() {
    if (this.frame >= this.frames) this.status = "finished";
    else this.frame++;
    this.changed();
  }

  set(values) {
    Object.assign(this, values);
    this.changed();
  }

  get scenes() {
    return [...SCENES, ...this.uploads.map((name) => ({ ...SCENES[2], name, title: name, description: "your mesh" }))];
  }

  get share() { return this.frame / this.frames; }

  state() {
    const { title, description, particles } = this.scenes.find(({ name }) => name === this.scene);
    const events = [[Math.round(.38 * this.frames), "first yield"], [Math.round(.6 * this.frames), "two pieces"]]
      .filter(([frame]) => frame <= this.frame).map(([frame, name]) => ({ frame, name }));
    const { revision, scene, status, reason, progress, frame, frames } = this;
    return {
      revision, scene, title, description, status, message: reason?.text ?? "", reason, progress, frame, frames,
      time: frame / 24, frame_rate: 24, particles, substeps: 35, dt: 1.19e-3, realtime_factor: .58,
      frames_per_second: 14, seconds: { simulate: .041, remesh: .012, render: .015, encode: .003 },
      ...this.counts(frame), camera: { eye: [-1.15, .95, 1.75], target: [0, .27, 0], fov: 30 }, events,
      notes: ["The body is split into 20,480 particles on 8 per cell.", "Surface particles lie on the surface."],
    };
  }

  counts(frame) {
    const share = frame / this.frames, broken = Math.round(3120 * Math.max(0, Math.min(1, (share - .42) / .3)) ** 2);
    return { broken_edges: broken, pieces: share > .6 ? 2 : 1, yielded: broken * 2, damaged: broken };
  }

  series(from) {
    const frames = Array.from({ length: Math.max(0, this.frame - from + 1) }, (_, i) => from + i);
    const column = (f) => frames.map((frame) => f(frame / this.frames, frame));
    const elastic = (t) => (t < .6 ? 30 * Math.min(.9, (t * 3) ** 1.5) : 6 + 20 * Math.exp(-(t - .6) * 30));
    return {
      from, frames, columns: {
        time: column((t, frame) => frame / 24), kinetic_energy: column((t) => 1 + (t > .6 ? 12 * Math.exp(-(t - .6) * 10) : 0)),
        elastic_energy: column(elastic), dissipated_energy: column((t) => 34 * Math.max(0, Math.min(1, (t - .35) / .4))),
        broken_edges: column((t, frame) => this.counts(frame).broken_edges),
        pieces: column((t, frame) => this.counts(frame).pieces),
        sim_seconds: column(() => .041), post_seconds: column(() => .012), render_seconds: column(() => .015),
      },
    };
  }

  patch(values) {
    const bad = [];
    for (const [id, value] of Object.entries(values)) {
      const known = this.parameters.find((entry) => entry.id === id);
      const fits = known && (known.choices ? known.choices.includes(value) : value >= known.min && value <= known.max);
      if (!fits) bad.push({ pointer: `/values/${id}`, detail: `${value} is not allowed for ${id}` });
    }
    if (bad.length) return bad;
    for (const [id, value] of Object.entries(values)) this.parameters.find((entry) => entry.id === id).value = value;
    this.changed();
    return [];
  }

  act(name, body) {
    this.actions.push({ name, ...body });
    if (name === "play" && this.status === "paused") this.status = "playing";
    else if (name === "pause" && this.status === "playing") this.status = "paused";
    else if (name === "reset") Object.assign(this, { frame: 0, status: "paused", reason: null });
    else if (name === "step") {
      if (this.frame < this.frames) this.frame += body.frames ?? 1;
      this.status = this.frame >= this.frames ? "finished" : "paused";
    }
    this.changed();
  }

  close() { clearInterval(this.timer); }
}

const json = (response, status, value) => {
  response.writeHead(status, { "content-type": status < 400 ? "application/json" : "application/problem+json" });
  response.end(JSON.stringify(value));
};
const body_of = async (request) => {
  const parts = [];
  for await (const part of request) parts.push(part);
  return Buffer.concat(parts);
};
const numbers = (text) => text.split(",").map(Number);

function picture(run, query, frame, scene = run.scene) {
  const width = Math.max(16, Math.min(run.most_width, Number(query.get("w") ?? 320)));
  const height = Math.max(9, Math.round(width * Number(query.get("h") ?? 200) / Number(query.get("w") ?? 320)));
  const view = {
    eye: numbers(query.get("eye") ?? "-1.15,0.95,1.75"), target: numbers(query.get("target") ?? "0,0.27,0"),
    fov: Number(query.get("fov") ?? 30), color: query.get("color") ?? "damage", theme: query.get("theme") ?? "light",
  };
  const { shape } = run.scenes.find(({ name }) => name === scene);
  return to_png(width, height, draw(width, height, view, frame / run.frames, shape));
}

async function send_frame(run, query, response) {
  const wanted = query.get("frame") ?? "live";
  run.frame_requests.push(Object.fromEntries(query));
  const token = () => `${run.revision}-${wanted === "live" ? run.frame : wanted}`;
  if (query.has("after") && query.get("after") === token()) await run.change_within(Number(query.get("wait") ?? 1000));
  if (run.status === "preparing" || query.get("after") === token()) return response.writeHead(204).end();
  const frame = wanted === "live" ? run.frame : Math.min(Number(wanted), run.frame);
  const bytes = picture(run, query, frame);
  response.writeHead(200, {
    "content-type": "image/jpeg", "cache-control": "no-store", "x-token": token(), "x-frame": frame,
    "x-time": frame / 24, "x-frames": run.frames, ...(query.get("color") === "stress" ? { "x-range": "0,20000" } : {}),
  });
  response.end(bytes);
}

async function answer_api(run, request, url, response) {
  const { pathname, searchParams: query } = url, what = `${request.method} ${pathname}`;
  const thumb = pathname.match(/^\/api\/scenes\/([^/]+)\/thumb\.jpg$/), png = pathname.match(/^\/api\/frames\/(\d+)\.png$/);
  if (what === "GET /api/version") {
    return json(response, 200, { version: "0.1.0", renderer: "mock", lanes: "none", capabilities: ["upload", "export"] });
  }
  if (what === "GET /api/scenes") {
    return json(response, 200, { current: run.scene, scenes: run.scenes.map(({ shape, ...rest }) => rest) });
  }
  if (thumb) {
    response.writeHead(200, { "content-type": "image/jpeg" });
    return response.end(picture(run, new URLSearchParams({ w: 160, h: 95, theme: query.get("theme") ?? "light" }), run.frames * .66,
      decodeURIComponent(thumb[1])));
  }
  if (what === "POST /api/scene") {
    const { name } = JSON.parse(await body_of(request));
    if (!run.scenes.some((scene) => scene.name === name)) return json(response, 422, { detail: `no scene ${name}`, pointer: "/name" });
    run.set({ scene: name, frame: 0, status: "paused", reason: null });
    return json(response, 200, { revision: run.revision });
  }
  if (what === "GET /api/state") {
    if (Number(query.get("after")) === run.revision) await run.change_within(Number(query.get("wait") ?? 0));
    return json(response, 200, run.state());
  }
  if (what === "GET /api/parameters") return json(response, 200, { revision: run.revision, parameters: run.parameters });
  if (what === "PATCH /api/parameters") {
    run.most_patches_in_flight = Math.max(run.most_patches_in_flight, ++run.patches_in_flight);
    const { seq, values } = JSON.parse(await body_of(request));
    if (run.patch_ms) await new Promise((done) => setTimeout(done, run.patch_ms));
    run.patches_in_flight--;
    run.patches.push({ seq, values });
    const bad = run.patch(values);
    if (bad.length) return json(response, 422, { title: "Bad value", detail: bad[0].detail, errors: bad });
    return json(response, 200, { revision: run.revision });
  }
  const action = pathname.match(/^\/api\/actions\/(play|pause|reset|step)$/);
  if (action && request.method === "POST") {
    run.act(action[1], JSON.parse(await body_of(request) || "{}"));
    return json(response, 200, { revision: run.revision });
  }
  if (what === "GET /api/frame.jpg") return send_frame(run, query, response);
  if (what === "GET /api/series") return json(response, 200, run.series(Number(query.get("from") ?? 0)));
  if (png) {
    response.writeHead(200, { "content-type": "image/png" });
    return response.end(picture(run, query, Number(png[1])));
  }
  if (/^\/api\/frames\/\d+\/mesh\.ply$/.test(pathname)) return response.end("ply\nformat ascii 1.0\nend_header\n");
  if (what === "POST /api/meshes") {
    const body = await body_of(request), name = query.get("name");
    if (body.includes("hole")) {
      return json(response, 422, { title: "Not a solid", detail: `${name} has 3 holes, the largest near (0.12, 0.40, 0.05) m.` });
    }
    const stem = name.replace(/\.\w+$/, "");
    run.uploads.push(stem);
    return json(response, 200, { name: stem, notes: ["31,220 particles."] });
  }
  return json(response, 404, { title: "Not found", detail: pathname });
}

async function answer_page(url, response) {
  const file = normalize(join(PAGE, url.pathname === "/" ? "index.html" : url.pathname));
  if (!file.startsWith(PAGE)) return response.writeHead(404).end();
  try {
    const bytes = await readFile(file);
    response.writeHead(200, {
      "content-type": TYPES[extname(file)] ?? "application/octet-stream", "content-security-policy": CSP, "cache-control": "no-store",
    });
    response.end(bytes);
  } catch {
    response.writeHead(404).end();
  }
}

/// {url, run, close()}.
export async function start_mock(options = {}) {
  const run = new MockRun(options);
  const server = createServer((request, response) => {
    const url = new URL(request.url, "http://mock");
    if (run.down) return request.socket.destroy();
    const answer = url.pathname.startsWith("/api/") ? answer_api(run, request, url, response) : answer_page(url, response);
    answer.catch((error) => { console.error(error); if (!response.headersSent) response.writeHead(500); response.end(); });
  });
  await new Promise((ready) => server.listen(options.port ?? 0, "127.0.0.1", ready));
  return {
    run, url: `http://127.0.0.1:${server.address().port}`,
    close() {
      run.close();
      server.closeAllConnections();
      return new Promise((done) => server.close(done));
    },
  };
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? "").href) {
  const { url } = await start_mock({ port: Number(process.env.PORT ?? 8081), most_width: 480 });
  console.log(url);
}
