// Keeps the page's copy of the server's state fresh by long poll and tells when the connection is lost.
import { Emitter } from "./emitter.js";
import { get_json, pause_for, send_json } from "./api.js";

const WAIT_MS = 10000;
const LEAST_GAP_MS = 60;

/// Events: "state" (every change), "scene" (another scene is asked for, and again once it is there with its title,
/// camera and view), "lost" {seconds}, "found".
export class Session extends Emitter {
  state = null;
  connected = true;
  #failures = 0;
  #announced = { scene: null, loaded: false };
  #wake = null;

  async run() {
    for (;;) {
      const started = performance.now();
      try {
        const after =
          this.connected && this.state ? `?after=${this.state.revision}&wait=${WAIT_MS}` : "";
        const timeout = AbortSignal.timeout(WAIT_MS + 5000);
        this.#accept(await get_json(`/api/state${after}`, { signal: timeout }));
      } catch (error) {
        await this.#hold_back();
      }
      await pause_for(Math.max(0, LEAST_GAP_MS - (performance.now() - started)));
    }
  }

  #accept(state) {
    const found = !this.connected;
    this.connected = true;
    this.#failures = 0;
    if (found) this.emit("found");
    const loaded = state.camera !== undefined,
      before = this.#announced;
    const other_scene = before.scene !== state.scene || (loaded && !before.loaded);
    if (other_scene) this.#announced = { scene: state.scene, loaded };
    const same =
      this.state && this.state.revision === state.revision && !found && !this.state.expected;
    this.state = state;
    if (other_scene) this.emit("scene", state);
    if (!same) this.emit("state", state);
  }

  async #hold_back() {
    const seconds = Math.min(8, 2 ** this.#failures++);
    this.connected = false;
    for (let left = seconds; left > 0; left--) {
      this.emit("lost", { seconds: left });
      const woken = await Promise.race([
        pause_for(1000),
        new Promise((resolve) => {
          this.#wake = () => resolve(true);
        }),
      ]);
      if (woken) break;
    }
  }

  /// Tries at once instead of waiting out the pause.
  try_now() {
    this.#failures = 0;
    this.#wake?.();
  }

  /// Sends an action and shows its expected outcome until the server's own word arrives.
  async act(name, body = {}, expected = {}) {
    if (this.state) {
      this.state = { ...this.state, ...expected, expected: true };
      this.emit("state", this.state);
    }
    return send_json("POST", `/api/actions/${name}`, body);
  }
}
