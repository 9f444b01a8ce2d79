// Starts the real rend server on a free port and talks to it.
import { spawn } from "node:child_process";
import { once } from "node:events";

/// How many times longer to wait than usual: sanitizers slow the program down.
export const patience = Number(process.env.REND_TEST_PATIENCE ?? 1);

export class RendServer {
  static async start(binary, root, scene = "tear") {
    const started = performance.now();
    const child = spawn(binary, ["serve", scene, "--port", "0"], {
      env: { ...process.env, REND_ROOT: root },
      stdio: ["ignore", "pipe", "pipe"],
    });
    const server = new RendServer();
    server.child = child;
    server.log = "";
    child.stderr.on("data", (data) => (server.log += data));
    let text = "";
    for await (const data of child.stdout) {
      text += data;
      const url = /http:\/\/[^\s]+/.exec(text);
      if (url) {
        server.url = url[0].replace(/\/$/, "");
        break;
      }
    }
    if (!server.url) throw new Error(`the server did not start: ${text} ${server.log}`);
    server.startSeconds = (performance.now() - started) / 1000;
    return server;
  }

  async get(path) {
    const response = await fetch(this.url + path);
    const type = response.headers.get("content-type") ?? "";
    return { status: response.status, headers: response.headers, body: type.includes("json") ? await response.json() : await response.arrayBuffer() };
  }

  async send(method, path, body = {}) {
    const response = await fetch(this.url + path, {
      method,
      headers: { "Content-Type": "application/json" },
      body: typeof body === "string" ? body : JSON.stringify(body),
    });
    return { status: response.status, body: await response.json() };
  }

  // Follows /api/state until `done(state)`; fails after `seconds`.
  async until(done, seconds = 240) {
    const deadline = Date.now() + 1000 * patience * seconds;
    let state = (await this.get("/api/state")).body;
    while (!done(state)) {
      if (Date.now() > deadline) throw new Error(`waited ${seconds} s in vain: ${JSON.stringify(state)}`);
      state = (await this.get(`/api/state?after=${state.revision}&wait=1000`)).body;
    }
    return state;
  }

  async stop() {
    const exited = this.child.exitCode === null ? once(this.child, "exit") : [this.child.exitCode];
    const begun = performance.now();
    this.child.kill("SIGTERM");
    const [code] = await exited;
    return { code, seconds: (performance.now() - begun) / 1000 };
  }
}
