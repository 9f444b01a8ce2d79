// The tools on the picture: which one a press uses, and the radius and strength of a pull.
import { Emitter } from "./emitter.js";
import { find, find_all, icon, make, set_text } from "./element.js";
import { clamp, format_number } from "./quantity.js";

const TOOLS = [
  ["pull", "Pull", "hand", "Press on the body and pull; beside it the view turns (1)"],
  ["probe", "Probe", "probe", "Point at the body to read its state (2)"],
  ["orbit", "Orbit", "orbit", "Every drag turns the view (3)"],
];
const STEPS = 100;
const RANGES = { radius: 4, strength: 30 };

const shown_length = (metres) =>
  metres < 1 ? `${format_number(metres * 100)} cm` : `${format_number(metres)} m`;
/// A force with its unit.
export const shown_force = (newton) =>
  newton < 1000 ? `${format_number(newton)} N` : `${format_number(newton / 1000)} kN`;

/// Events: "change". `tool` is "pull", "probe" or "orbit"; `radius` [m] and `strength` [N] those of the next pull.
export class Tools extends Emitter {
  tool = "";
  radius = 0;
  strength = 0;
  #suits = "";
  #standard = null;

  constructor(session) {
    super();
    const palette = find("#tools");
    palette.append(...TOOLS.map((tool) => this.#button(...tool)));
    palette.hidden = false;
    for (const kind of ["radius", "strength"])
      find(`#pull-${kind}`).addEventListener("input", () => this.#slide(kind));
    session.on("state", ({ scene, grip }) => {
      const key = grip ? `${scene} ${grip.radius} ${grip.strength}` : "";
      if (!key || key === this.#suits) return;
      // A changed threshold moves the middle of the sliders; what somebody chose stays in its scene.
      const same_scene = this.#suits.startsWith(`${scene} `);
      this.#suits = key;
      const chosen = same_scene && ["radius", "strength"].map((kind) => this[kind] / this.#standard[kind]);
      this.#standard = grip;
      ["radius", "strength"].forEach((kind, i) => (this[kind] = grip[kind] * (chosen ? chosen[i] : 1)));
      this.#draw();
    });
    const kept = sessionStorage.getItem("tool");
    this.choose(TOOLS.some(([name]) => name === kept) ? kept : "pull");
  }

  choose(name) {
    const again = name === this.tool;
    this.tool = name;
    sessionStorage.setItem("tool", name);
    const options = find("#pull-options");
    options.hidden = name !== "pull" || !again || !options.hidden;
    for (const node of find_all(".tool"))
      node.setAttribute("aria-pressed", String(node.dataset.tool === name));
    find(".stage").dataset.tool = name;
    this.emit("change");
  }

  choose_nth(n) {
    if (TOOLS[n]) this.choose(TOOLS[n][0]);
  }

  /// Makes the grip wider or narrower.
  widen(factor) {
    if (!this.#standard) return;
    const { radius } = this.#standard;
    this.radius = clamp(this.radius * factor, radius / RANGES.radius, radius * RANGES.radius);
    this.#draw();
  }

  #button(name, label, symbol, title) {
    const button = make("button", {
      class: "tool",
      "data-tool": name,
      title,
      "aria-pressed": "false",
      on_click: () => this.choose(name),
    });
    button.append(icon(symbol), label);
    return button;
  }

  #slide(kind) {
    if (!this.#standard) return;
    const t = find(`#pull-${kind}`).value / STEPS;
    this[kind] = this.#standard[kind] * RANGES[kind] ** (2 * t - 1);
    this.#draw();
  }

  #draw() {
    for (const [kind, shown] of [
      ["radius", shown_length],
      ["strength", shown_force],
    ]) {
      const slider = find(`#pull-${kind}`),
        share = this[kind] / this.#standard[kind];
      slider.value = Math.round((STEPS * (Math.log(share) / Math.log(RANGES[kind]) + 1)) / 2);
      slider.style.setProperty("--at", `${slider.value}%`);
      slider.setAttribute("aria-valuetext", shown(this[kind]));
      set_text(find(`#pull-${kind}-text`), shown(this[kind]));
    }
    this.emit("change");
  }
}
