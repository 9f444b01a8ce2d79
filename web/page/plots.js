// The plots panel: the energy balance, momentum, broken edges with pieces, and what a frame costs.
import { find, make, set_text } from "./element.js";
import { EnergySheet, MOMENTA } from "./energy.js";
import { format_count, format_number } from "./quantity.js";
import { Plot } from "./plot.js";

const STAGES = [
  ["simulate", "--accent"],
  ["remesh", "--warm"],
  ["render", "--edge"],
  ["encode", "--ink"],
];

export class Plots {
  #series;
  #playhead;
  #session;
  #energy;
  #sheet;
  #momentum;
  #fracture;

  constructor(session, series, playhead) {
    this.#series = series;
    this.#playhead = playhead;
    this.#session = session;
    const seek = (frame) => playhead.seek(frame);
    this.#energy = new Plot(find("#energy-plot"), seek);
    this.#fracture = new Plot(find("#fracture-plot"), seek);
    this.#sheet = new EnergySheet(series);
    this.#momentum = new Plot(find("#momentum-plot"), seek);
    find("#cost-key").append(
      ...STAGES.map(([name]) =>
        make("span", {}, `${name} `, make("b", { id: `cost-${name}` }, "–")),
      ),
    );
    find("#cost").append(
      ...STAGES.map(([, color]) => make("i", { "--key": `var(${color})`, "--share": 1 })),
    );
    series.on("change", () => this.#draw());
    playhead.on("change", () => this.#draw());
    session.on("state", (state) => this.#draw_cost(state.seconds ?? {}));
  }

  #draw() {
    const { frames, columns } = this.#series;
    const { frame, total } = this.#playhead;
    this.#energy.show(this.#sheet.curves(), frames, total, frame);
    this.#sheet.show(frame);
    this.#momentum.show(
      MOMENTA.map(([column, , color, dash]) => ({ values: columns[column] ?? [], color, dash })),
      frames,
      total,
      frame,
    );
    const pieces = columns.pieces ?? [];
    this.#fracture.show(
      [
        { values: columns.broken_edges ?? [], color: "--warm" },
        { values: pieces, color: "--ink", dash: "dashed", top: Math.max(2, ...pieces) * 1.05 },
      ],
      frames,
      total,
      frame,
    );

    const broken = this.#series.at("broken_edges", frame),
      count = this.#series.at("pieces", frame);
    find("#fracture-figures").replaceChildren(
      make(
        "em",
        { "--key": "var(--warm)" },
        `${broken === undefined ? "–" : format_count(broken)} broken edges`,
      ),
      make(
        "em",
        { "--key": "var(--ink)", "--dash": "dashed" },
        count === 1 ? "1 piece" : `${count ?? "–"} pieces`,
      ),
    );
    const momenta = MOMENTA.map(([column, name]) => [
      name,
      format_number(this.#series.at(column, frame) ?? NaN),
    ]);
    find("#momentum-figures").replaceChildren(
      ...MOMENTA.map(([, name, color, dash], i) =>
        make("em", { "--key": `var(${color})`, "--dash": dash }, `${name} ${momenta[i][1]}`),
      ),
    );
    find("#momentum-plot").setAttribute(
      "aria-label",
      `Momentum over time; now ${momenta.map((pair) => pair.join(" ")).join(", ")} kilogram metres per second`,
    );
    find("#fracture-plot").setAttribute(
      "aria-label",
      `Broken edges and pieces over time; now ${broken ?? 0} edges, ${count ?? 0} pieces`,
    );
  }

  #draw_cost(seconds) {
    const values = STAGES.map(([name]) => (seconds[name] ?? 0) * 1000);
    const sum = values.reduce((a, b) => a + b, 0);
    set_text(find("#cost-figures"), `${format_number(sum)} ms`);
    [...find("#cost").children].forEach((bar, i) =>
      bar.style.setProperty("--share", sum ? values[i] / sum : 1),
    );
    STAGES.forEach(([name], i) => set_text(find(`#cost-${name}`), format_number(values[i], 2)));
    find("#cost").setAttribute(
      "aria-label",
      `Milliseconds per stage: ${STAGES.map(([name], i) => `${name} ${format_number(values[i], 2)}`).join(", ")}`,
    );
  }
}
