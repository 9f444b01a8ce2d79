// The energy balance of a run: what went in, where it is now, and the remainder that transfers took.
import { find, make, set_text } from "./element.js";
import { format_number } from "./quantity.js";

/// [columns that add up, words, colour, dash, whether it is something that went in].
const ENTRIES = [
  [["start_energy"], "at the start", "--dim", "dotted", true],
  [["external_work"], "external work", "--dim", "solid", true],
  [["kinetic_energy", "affine_energy"], "kinetic", "--edge", "dashed", false],
  [["elastic_energy"], "elastic", "--ink", "solid", false],
  [["gravity_change"], "lifted", "--edge", "dotted", false],
  [["dissipated_energy"], "dissipated", "--warm", "solid", false],
  [["friction_energy"], "friction", "--warm", "dashed", false],
  [["transfer_loss"], "transfer loss", "--ink", "dotted", false],
];

/// [column, words, colour, dash].
export const MOMENTA = [
  ["momentum_x", "x", "--warm", "solid"],
  ["momentum_y", "y", "--ink", "solid"],
  ["momentum_z", "z", "--edge", "dashed"],
];

// Shares of the largest energy below which an entry is left out.
const NOTHING = 1e-4;

export class EnergySheet {
  #series;
  #curves = [];
  #shown = [];

  constructor(series) {
    this.#series = series;
  }

  /// Curves for the plot; what a scene never has is left out.
  curves() {
    const { columns, frames } = this.#series;
    const entries = ENTRIES.map(([names, words, color, dash, went_in]) => {
      const values = frames.map((_, i) =>
        names.reduce((sum, name) => sum + (columns[name]?.[i] ?? 0), 0),
      );
      const size = values.reduce((most, value) => Math.max(most, Math.abs(value) || 0), 0);
      return { values, words, color, dash, went_in, size };
    });
    const largest = Math.max(0, ...entries.map(({ size }) => size));
    this.#curves = entries.filter(({ size }) => size > NOTHING * largest);
    return this.#curves.map(({ values, color, dash }) => ({ values, color, dash }));
  }

  /// Writes the figures of one frame.
  show(frame) {
    const i = this.#series.index_of(frame),
      drift = this.#series.at("energy_drift", frame);
    const figures = this.#curves.map(({ words, values }) => [
      words,
      `${format_number(values[i] ?? NaN)} J`,
    ]);
    this.#fit_rows();
    this.#shown.forEach((cell, n) => set_text(cell, figures[n][1]));
    const percent = Number.isFinite(drift) ? `${format_number(100 * Math.abs(drift), 2)} %` : "–";
    set_text(find("#energy-figures"), drift < 0 ? `${percent} gained` : `${percent} lost in transfers`);
    find("#energy-plot").setAttribute(
      "aria-label",
      `Energies over time; now ${figures.map((pair) => pair.join(" ")).join(", ")}`,
    );
  }

  #fit_rows() {
    const list = find("#energy-sheet"),
      key = this.#curves.map(({ words }) => words).join();
    if (list.dataset.key === key) return;
    list.dataset.key = key;
    this.#shown = this.#curves.map(() => make("dd", {}));
    list.replaceChildren(
      ...this.#curves.map(({ words, color, dash, went_in }, n) =>
        make(
          "div",
          {},
          make("dt", { "--key": `var(${color})`, "--dash": dash }, went_in ? `+ ${words}` : words),
          this.#shown[n],
        ),
      ),
    );
  }
}
