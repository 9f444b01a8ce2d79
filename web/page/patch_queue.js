// Sends changed values: the newest wins, at most one request in flight, 50 ms between two.
import { pause_for, send_json } from "./api.js";

const LEAST_GAP_MS = 50;

export class PatchQueue {
  #waiting = new Map();
  #busy = false;
  #refused;
  #accepted;

  /// `refused(error, ids)` hears what the server did not take, `accepted(ids)` what it did.
  constructor(refused, accepted) {
    this.#refused = refused;
    this.#accepted = accepted;
  }

  put(id, value) {
    this.#waiting.set(id, value);
    this.#send();
  }

  holds(id) {
    return this.#waiting.has(id);
  }

  async #send() {
    if (this.#busy) return;
    this.#busy = true;
    while (this.#waiting.size) {
      const values = Object.fromEntries(this.#waiting);
      this.#waiting.clear();
      try {
        await send_json("PATCH", "/api/parameters", { values });
        this.#accepted(Object.keys(values));
      } catch (error) {
        this.#refused(error, Object.keys(values));
      }
      await pause_for(LEAST_GAP_MS);
    }
    this.#busy = false;
  }
}
