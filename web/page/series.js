// The run's figures per frame, fetched piece by piece as frames are recorded.
import { Emitter } from "./emitter.js";
import { get_json } from "./api.js";

const LEAST_GAP_MS = 400;

/// Events: "change".
export class Series extends Emitter {
  frames = [];
  columns = {};
  #busy = false;
  #again = false;

  constructor(session) {
    super();
    session.on("scene", () => this.#clear());
    session.on("found", () => this.#clear());
    session.on("state", (state) => {
      const last = this.frames.at(-1) ?? -1;
      if (state.frame < last) this.#clear();
      if (state.frame > (this.frames.at(-1) ?? -1)) this.#fetch();
    });
  }

  /// Index of a frame, or of the last one before it; -1 when nothing is recorded.
  index_of(frame) {
    let i = this.frames.length - 1;
    while (i >= 0 && this.frames[i] > frame) i--;
    return i;
  }

  at(name, frame) {
    return this.columns[name]?.[this.index_of(frame)];
  }

  csv() {
    const names = Object.keys(this.columns);
    const rows = this.frames.map((frame, i) =>
      [frame, ...names.map((name) => this.columns[name][i])].join(","),
    );
    return [["frame", ...names].join(","), ...rows].join("\n") + "\n";
  }

  #clear() {
    this.frames = [];
    this.columns = {};
    this.emit("change");
  }

  async #fetch() {
    if (this.#busy) {
      this.#again = true;
      return;
    }
    this.#busy = true;
    this.#again = false;
    try {
      const first = (this.frames.at(-1) ?? -1) + 1,
        held = this.frames;
      const { frames, columns } = await get_json(`/api/series?from=${first}`);
      if (held === this.frames) this.#append(frames, columns);
    } catch {
      // The next recorded frame asks again.
    }
    setTimeout(() => {
      this.#busy = false;
      if (this.#again) this.#fetch();
    }, LEAST_GAP_MS);
  }

  #append(frames, columns) {
    const skip = frames.findIndex((frame) => frame > (this.frames.at(-1) ?? -1));
    if (skip < 0) return;
    const before = this.frames.length;
    this.frames.push(...frames.slice(skip));
    for (const [name, values] of Object.entries(columns)) {
      this.columns[name] ??= new Array(before).fill(NaN);
      this.columns[name].push(...values.slice(skip));
    }
    this.emit("change");
  }
}
