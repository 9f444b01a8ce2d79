// A server with the program's HTTP interface and an invented run, so that the page is tested on its own.
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { extname, join, normalize } from "node:path";
import { after } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { draw, to_png } from "./fake_picture.mjs";
import { MockRun } from "./mock_run.mjs";

const PAGE = fileURLToPath(new URL("../../web/page/", import.meta.url));
const TYPES = {
  ".html": "text/html",
  ".css": "text/css",
  ".js": "text/javascript",
  ".svg": "image/svg+xml",
};
const CSP = "default-src 'self'; img-src 'self' blob: data:";

const json = (response, status, value) => {
  response.writeHead(status, {
    "content-type": status < 400 ? "application/json" : "application/problem+json",
  });
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
  const height = Math.max(
    9,
    Math.round((width * Number(query.get("h") ?? 200)) / Number(query.get("w") ?? 320)),
  );
  const view = {
    eye: numbers(query.get("eye") ?? "-1.15,0.95,1.75"),
    target: numbers(query.get("target") ?? "0,0.27,0"),
    fov: Number(query.get("fov") ?? 30),
    color: query.get("color") ?? "damage",
    theme: query.get("theme") ?? "light",
  };
  const { shape } = run.scenes.find(({ name }) => name === scene);
  return to_png(width, height, draw(width, height, view, frame / run.frames, shape));
}

async function send_frame(run, query, response) {
  const wanted = query.get("frame") ?? "live";
  run.frame_requests.push(Object.fromEntries(query));
  const token = () => `${run.revision}-${wanted === "live" ? run.frame : wanted}`;
  if (query.has("after") && query.get("after") === token())
    await run.change_within(Number(query.get("wait") ?? 1000));
  if (run.status === "preparing" || query.get("after") === token())
    return response.writeHead(204).end();
  if (run.picture_ms) await new Promise((done) => setTimeout(done, run.picture_ms));
  const frame = wanted === "live" ? run.frame : Math.min(Number(wanted), run.frame);
  const bytes = picture(run, query, frame);
  response.writeHead(200, {
    "content-type": "image/jpeg",
    "cache-control": "no-store",
    "x-token": token(),
    "x-frame": frame,
    "x-time": frame / 24,
    "x-frames": run.frames,
    "x-legend":
      { stress: "0;20;Largest stress, kPa", speed: "0;0.5;Speed, m/s" }[query.get("color")] ??
      "0;1;Damage",
  });
  response.end(bytes);
}

async function answer_api(run, request, url, response) {
  const { pathname, searchParams: query } = url,
    what = `${request.method} ${pathname}`;
  const thumb = pathname.match(/^\/api\/scenes\/([^/]+)\/thumb\.jpg$/),
    png = pathname.match(/^\/api\/frames\/(\d+)\.png$/);
  if (what === "GET /api/version") {
    return json(response, 200, {
      version: "0.1.0",
      renderer: "mock",
      lanes: "none",
      capabilities: ["upload", "export"],
    });
  }
  if (what === "GET /api/scenes") {
    return json(response, 200, {
      current: run.scene,
      scenes: run.scenes.map(({ shape, ...rest }) => rest),
    });
  }
  if (thumb) {
    response.writeHead(200, { "content-type": "image/jpeg" });
    return response.end(
      picture(
        run,
        new URLSearchParams({ w: 160, h: 95, theme: query.get("theme") ?? "light" }),
        run.frames * 0.66,
        decodeURIComponent(thumb[1]),
      ),
    );
  }
  if (what === "POST /api/scene") {
    const { name } = JSON.parse(await body_of(request));
    if (!run.scenes.some((scene) => scene.name === name))
      return json(response, 422, { detail: `no scene ${name}`, pointer: "/name" });
    run.set({ scene: name, frame: 0, status: "paused", reason: null });
    return json(response, 200, { revision: run.revision });
  }
  if (what === "GET /api/state") {
    run.heard = Number(query.get("after"));
    if (Number(query.get("after")) === run.revision)
      await run.change_within(Number(query.get("wait") ?? 0));
    return json(response, 200, run.state());
  }
  if (what === "GET /api/parameters")
    return json(response, 200, { revision: run.revision, parameters: run.parameters });
  if (what === "PATCH /api/parameters") {
    run.most_patches_in_flight = Math.max(run.most_patches_in_flight, ++run.patches_in_flight);
    const { values, ...unknown } = JSON.parse(await body_of(request));
    if (Object.keys(unknown).length) return json(response, 422, { title: "Unknown key", detail: `${Object.keys(unknown)}` });
    if (run.patch_ms) await new Promise((done) => setTimeout(done, run.patch_ms));
    run.patches_in_flight--;
    run.patches.push(values);
    const bad = run.patch(values);
    if (bad.length)
      return json(response, 422, { title: "Bad value", detail: bad[0].detail, errors: bad });
    return json(response, 200, { revision: run.revision });
  }
  const action = pathname.match(/^\/api\/actions\/(play|pause|reset|step)$/);
  if (action && request.method === "POST") {
    run.act(action[1], JSON.parse((await body_of(request)) || "{}"));
    return json(response, 200, { revision: run.revision });
  }
  if (what === "GET /api/probe") {
    await run.looking;
    return json(response, 200, run.probe(query));
  }
  if (what === "POST /api/pull") {
    const pull = JSON.parse(await body_of(request));
    if (pull.radius && run.status === "finished")
      return json(response, 409, { title: "Run ended", detail: "The run has ended; reset it to pull." });
    run.act_on(pull);
    return json(response, 200, { revision: run.revision });
  }
  if (what === "GET /api/frame.jpg") return send_frame(run, query, response);
  if (what === "GET /api/series")
    return json(response, 200, run.series(Number(query.get("from") ?? 0)));
  if (png) {
    response.writeHead(200, { "content-type": "image/png" });
    return response.end(picture(run, query, Number(png[1])));
  }
  if (/^\/api\/frames\/\d+\/mesh\.(ply|vtp|obj|glb)$/.test(pathname))
    return response.end("ply\nformat ascii 1.0\nend_header\n");
  if (what === "GET /api/exports")
    return json(response, 200, { running: run.exported?.status === "running" ? run.look_at_export() : null });
  if (what === "POST /api/exports") {
    if (run.exported?.status === "running")
      return json(response, 409, { title: "Conflict", detail: "Another export is running." });
    return json(response, 200, { id: run.start_export(JSON.parse(await body_of(request)), query) });
  }
  if (what === `DELETE /api/exports/${run.exported?.id}`) {
    run.exported.status = "cancelled";
    return json(response, 200, { id: run.exported.id });
  }
  if (what === `GET /api/exports/${run.exported?.id}`) return json(response, 200, run.look_at_export());
  if (what === `GET /api/exports/${run.exported?.id}/file`) {
    response.writeHead(200, { "content-type": "application/zip" });
    return response.end("PK");
  }
  if (what === "POST /api/meshes") {
    const body = await body_of(request),
      name = query.get("name");
    if (body.includes("hole")) {
      return json(response, 422, {
        title: "Not a solid",
        detail: `${name} has 3 holes, the largest near (0.12, 0.40, 0.05) m.`,
      });
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
      "content-type": TYPES[extname(file)] ?? "application/octet-stream",
      "content-security-policy": CSP,
      "cache-control": "no-store",
    });
    response.end(bytes);
  } catch {
    response.writeHead(404).end();
  }
}

const open = new Set();

// What failed tests left open would keep Node alive.
after(() => Promise.all([...open].map((mock) => mock.close())));

/// {url, run, close()}.
export async function start_mock(options = {}) {
  const run = new MockRun(options);
  const server = createServer((request, response) => {
    const url = new URL(request.url, "http://mock");
    if (run.down) return request.socket.destroy();
    const answer = url.pathname.startsWith("/api/")
      ? answer_api(run, request, url, response)
      : answer_page(url, response);
    answer.catch((error) => {
      console.error(error);
      if (!response.headersSent) response.writeHead(500);
      response.end();
    });
  });
  await new Promise((ready) => server.listen(options.port ?? 0, "127.0.0.1", ready));
  const mock = {
    run,
    url: `http://127.0.0.1:${server.address().port}`,
    close() {
      open.delete(mock);
      run.close();
      server.closeAllConnections();
      return new Promise((done) => server.close(done));
    },
  };
  open.add(mock);
  return mock;
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? "").href) {
  const { url } = await start_mock({ port: Number(process.env.PORT ?? 8081), most_width: 480 });
  console.log(url);
}
