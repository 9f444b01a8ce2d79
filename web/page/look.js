// View settings of this page: what the colours mean, surface or particles, and the legend.
import { find, find_all, make, set_text } from "./element.js";
import { format_number } from "./quantity.js";

const CLAY = "#e4ded2", CRACK = "#cd603c";
const DAMAGE = `linear-gradient(90deg, ${CLAY}, #e8c87e, #d48838, #8f3518)`;
const CIVIDIS = "linear-gradient(90deg, #00204d, #414d6b, #7c7b78, #bcaf6f, #ffea46)";
const LEGENDS = {
  damage: { caption: "Damage", ramp: DAMAGE, ends: ["0", "0.5", "1"] },
  stress: { caption: "Largest principal stress", ramp: CIVIDIS, ends: ["low", "high"], factor: 1e3, unit: "kPa" },
  speed: { caption: "Speed", ramp: CIVIDIS, ends: ["low", "high"], factor: 1, unit: "m/s" },
  yielded: { caption: "Yielded", swatches: [[CLAY, "elastic"], ["#d48838", "yielded"], [CRACK, "crack face"]] },
  piece: { caption: "One colour a piece" },
};

/// `changed()` after each change; `remember(revert)` puts it on the undo stack.
export class Look {
  color = "damage";
  mode = "surface";
  #changed;
  #range = null;

  constructor(changed, remember) {
    this.#changed = changed;
    find("#color").addEventListener("change", (event) => this.#choose({ color: event.target.value }, remember));
    for (const input of find_all("[name=view-mode]")) {
      input.addEventListener("change", () => this.#choose({ mode: input.value }, remember));
    }
    this.#draw();
  }

  values() { return { color: this.color, mode: this.mode }; }

  /// The ends of the colour scale of the picture that is shown, where the server tells them.
  set_range(range) {
    const usable = range?.length === 2 && range.every(Number.isFinite) ? range : null;
    if (String(usable) === String(this.#range)) return;
    this.#range = usable;
    this.#draw();
  }

  /// The scene's own view, when another scene is loaded.
  adopt({ color = this.color, mode = this.mode } = {}) {
    if (color !== this.color || mode !== this.mode) this.#apply({ color, mode });
  }

  #choose(values, remember) {
    const before = this.values();
    this.#apply(values);
    remember(() => this.#apply(before));
  }

  #apply(values) {
    Object.assign(this, values);
    this.#range = null;
    find("#color").value = this.color;
    for (const input of find_all("[name=view-mode]")) input.checked = input.value === this.mode;
    this.#draw();
    this.#changed();
  }

  #draw() {
    const legend = LEGENDS[this.color];
    find("#legend").hidden = !legend;
    if (!legend) return;
    const { caption, ramp, swatches, unit, factor = 1 } = legend;
    set_text(find("#legend-caption"), unit && this.#range ? `${caption}, ${unit}` : caption);
    find("#legend-ramp").hidden = !ramp;
    if (ramp) find("#legend-ramp").style.setProperty("--ramp", ramp);
    const [low, high] = (this.#range ?? []).map((value) => value / factor);
    const ends = this.#range && unit ? [low, (low + high) / 2, high].map((x) => format_number(x, 2)) : legend.ends;
    find("#legend-ends").className = swatches ? "swatches" : "";
    find("#legend-ends").replaceChildren(...(swatches
      ? swatches.map(([color, name]) => make("b", { "--swatch": color }, name))
      : (ends ?? []).map((end) => make("b", {}, end))));
  }
}
