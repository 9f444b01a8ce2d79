// View settings of this page: what the colours mean, surface or particles, and the legend.
import { find, find_all, make, set_text } from "./element.js";
import { format_number } from "./quantity.js";

const CLAY = "#e4ded2",
  CRACK = "#cd603c";
const DAMAGE = `linear-gradient(90deg, ${CLAY}, #e8c87e, #d48838, #8f3518)`;
const CIVIDIS = "linear-gradient(90deg, #00204d, #414d6b, #7c7b78, #bcaf6f, #ffea46)";
const LEGENDS = {
  damage: { caption: "Damage", ramp: DAMAGE },
  stress: { caption: "Largest stress", ramp: CIVIDIS },
  speed: { caption: "Speed", ramp: CIVIDIS },
  threshold: { caption: "Share of break threshold", ramp: CIVIDIS },
  yielded: {
    caption: "Yielded",
    swatches: [
      [CLAY, "elastic"],
      ["#8f3518", "yielded"],
      [CRACK, "crack face"],
    ],
  },
  piece: { caption: "One colour a piece" },
};

/// `changed()` after each change; `remember(revert)` puts it on the undo stack.
export class Look {
  color = "damage";
  mode = "surface";
  #changed;
  #scale = null;
  #drawn = "";

  constructor(changed, remember) {
    this.#changed = changed;
    find("#color").addEventListener("change", (event) =>
      this.#choose({ color: event.target.value }, remember),
    );
    for (const input of find_all("[name=view-mode]")) {
      input.addEventListener("change", () => this.#choose({ mode: input.value }, remember));
    }
    this.#draw();
  }

  values() {
    return { color: this.color, mode: this.mode };
  }

  /// The colour scale of the picture that is shown, "LOW;HIGH;CAPTION" as the server tells it.
  set_legend(text) {
    const [low, high, caption] = (text ?? "").split(";");
    const usable = caption && Number(high) > Number(low);
    this.#scale = usable ? { low: Number(low), high: Number(high), caption } : null;
    this.#draw();
  }

  /// The scene's own view, when another scene is loaded.
  adopt({ color = this.color, mode = this.mode } = {}) {
    const known = find(`#color option[value="${CSS.escape(color)}"]`) && /^(surface|particles)$/.test(mode);
    if (known && (color !== this.color || mode !== this.mode)) this.#apply({ color, mode });
  }

  #choose(values, remember) {
    const before = this.values();
    this.#apply(values);
    remember(() => this.#apply(before));
  }

  #apply(values) {
    Object.assign(this, values);
    this.#scale = null;
    find("#color").value = this.color;
    for (const input of find_all("[name=view-mode]")) input.checked = input.value === this.mode;
    this.#draw();
    this.#changed();
  }

  #draw() {
    const legend = LEGENDS[this.color];
    find("#legend").hidden = !legend;
    if (!legend) return;
    const { ramp, swatches } = legend;
    const { low, high, caption } = (ramp && this.#scale) || { caption: legend.caption };
    const ends = !ramp
      ? []
      : low === undefined
        ? ["low", "high"]
        : [low, (low + high) / 2, high].map((x) => format_number(x, 2));
    const key = JSON.stringify([this.color, caption, ends]);
    if (key === this.#drawn) return;
    this.#drawn = key;
    set_text(find("#legend-caption"), caption);
    find("#legend-ramp").hidden = !ramp;
    if (ramp) find("#legend-ramp").style.setProperty("--ramp", ramp);
    find("#legend-ends").className = swatches ? "swatches" : "";
    find("#legend-ends").replaceChildren(
      ...(swatches
        ? swatches.map(([color, name]) => make("b", { "--swatch": color }, name))
        : ends.map((end) => make("b", {}, end))),
    );
  }
}
