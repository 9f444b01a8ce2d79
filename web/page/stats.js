// The bar of figures at the bottom.
import { find, make, set_text } from "./element.js";
import { format_count, format_number } from "./quantity.js";

/// [id, words after the figure, hidden on a phone, figure of the state].
const FIGURES = [
  ["particles", "particles", false, (state) => format_count(state.particles ?? 0)],
  ["steps", "steps per frame", true, (state) => format_count(state.substeps ?? 0)],
  ["step", "ms time step", true, (state) => format_number((state.dt ?? 0) * 1000)],
  ["factor", "real time", false, (state) => `${format_number(state.realtime_factor ?? 0, 2)}×`],
  ["yielded", "yielded", true, (state) => format_count(state.yielded ?? 0)],
  ["damaged", "damaged", true, (state) => format_count(state.damaged ?? 0)],
];

export function show_stats(session, picture) {
  const figures = FIGURES.map(([id, words, optional]) =>
    make(
      "span",
      { class: optional ? "optional" : null },
      make("b", { id: `stat-${id}` }, "–"),
      ` ${words}`,
    ),
  );
  find("#stats").append(
    ...figures,
    make("span", {}, make("b", { id: "stat-rate" }, "0"), " frames/s"),
  );
  session.on("state", (state) => {
    for (const [id, , , figure] of FIGURES) set_text(find(`#stat-${id}`), figure(state));
  });
  let last = 0;
  picture.on("shown", () => {
    last = performance.now();
  });
  setInterval(() => {
    const idle = performance.now() - last > 1500;
    set_text(find("#stat-rate"), idle ? "0" : format_count(picture.rate));
  }, 500);
}
