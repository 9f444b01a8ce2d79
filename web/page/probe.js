// Reading the matter under the pointer: damage, threshold, stress, where it was at rest.
import { find, make } from "./element.js";
import { get_json } from "./api.js";
import { clamp, format_count, format_number, shown_unit } from "./quantity.js";

const pressure = (pascal) => {
  const { factor, text } = shown_unit({ unit: "Pa", default: pascal });
  return `${format_number(pascal / factor)} ${text}`;
};
const metres = (vector) => `${vector.map((x) => format_number(Number(x.toFixed(4)))).join(", ")} m`;

/// [words, figure] of what the server found.
export function rows_of(matter) {
  const rows = [
    ["Damage", format_number(matter.damage, 2)],
    ["Threshold τc", matter.threshold > 0 ? pressure(matter.threshold) : "none left"],
    ["Largest stress", pressure(matter.stress)],
    ["Share of break threshold", format_number(matter.share_of_break_threshold, 2)],
    ["Speed", `${format_number(Math.hypot(...matter.velocity), 2)} m/s`],
    ["At rest", metres(matter.rest)],
    ["Now", metres(matter.position)],
    ["Particle", `${format_count(matter.particle)}, ${matter.material}`],
  ];
  if (matter.damage < 1 && !matter.yielded) rows[1][1] += ", elastic";
  if (matter.piece >= 0)
    rows.push(["Piece", `${matter.piece}${matter.crack ? ", crack face" : ""}`]);
  return rows;
}

export class ProbeTool {
  #picture;
  #playhead;
  #tools;
  #canvas;
  #place = null;
  #busy = false;

  constructor({ canvas, playhead, picture, tools }) {
    this.#canvas = canvas;
    this.#picture = picture;
    this.#playhead = playhead;
    this.#tools = tools;
    const place_of = (event) => {
      const box = canvas.getBoundingClientRect();
      return { x: (event.clientX - box.x) / box.width, y: (event.clientY - box.y) / box.height };
    };
    const point = (event) => this.#point(place_of(event));
    canvas.addEventListener("pointerdown", point);
    canvas.addEventListener("pointermove", (event) => {
      if (!event.buttons) point(event);
    });
    canvas.addEventListener("pointerleave", (event) => {
      if (event.pointerType === "mouse") this.#point(null);
    });
    canvas.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.#point({ x: 0.5, y: 0.5 });
      if (event.key === "Escape") this.#point(null);
    });
    tools.on("change", () => {
      if (tools.tool !== "probe") this.#point(null);
    });
    // The same place on another frame is other matter.
    picture.on("shown", () => this.#point(this.#place));
  }

  #point(place) {
    this.#place = this.#tools.tool === "probe" ? place : null;
    if (!this.#place) find("#probe").hidden = true;
    else this.#ask();
  }

  async #ask() {
    if (this.#busy) return;
    this.#busy = true;
    let asked = null;
    while (this.#place && this.#place !== asked) {
      asked = this.#place;
      const query = {
        ...this.#picture.view_query(),
        ...asked,
        w: 1280,
        h: Math.max(16, Math.round(1280 / this.#picture.aspect)),
        frame: this.#playhead.wanted,
      };
      try {
        const { matter } = await get_json(`/api/probe?${new URLSearchParams(query)}`);
        if (this.#place) this.#show(matter, asked);
      } catch {
        find("#probe").hidden = true;
      }
    }
    this.#busy = false;
  }

  #show(matter, { x, y }) {
    const card = find("#probe");
    card.hidden = !matter;
    if (!matter) return;
    card.replaceChildren(
      ...rows_of(matter).map(([words, figure]) =>
        make("div", {}, make("dt", {}, words), make("dd", {}, figure)),
      ),
    );
    const { clientWidth: w, clientHeight: h } = this.#canvas;
    const left = x * w + 16 + card.offsetWidth > w ? x * w - 16 - card.offsetWidth : x * w + 16;
    card.style.setProperty("--x", `${clamp(left, 8, Math.max(8, w - card.offsetWidth - 8))}px`);
    card.style.setProperty("--y", `${clamp(y * h + 16, 8, Math.max(8, h - card.offsetHeight - 8))}px`);
  }
}
