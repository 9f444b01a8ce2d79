// The ensembles, their tables and their plot.
#include "bench/bench_cracks.h"

#include "bench/problems/method.h"
#include "engine/scene/crack_band.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

// The energy of a crack that each law is given, and the modulus that it amounts to at the coarsest
// dx: both laws start alike and part as dx falls.
struct Laws {
  Real fracture_energy;  // [J/m2]
  Real modulus;          // [Pa]

  std::string text(bool by_energy) const {
    return by_energy ? fmt::format("\"fracture_energy\": {}", fracture_energy)
                     : fmt::format("\"softening\": {}", modulus);
  }
};

Laws laws(Real fracture_energy, Real tau_c, Real dx, bool mesh) {
  const Real band =
      crack_band_width(Kernel::quadratic, mesh ? ForceKind::mesh : ForceKind::particle, dx,
                       2 * fracture_energy / tau_c);
  return {fracture_energy, band * tau_c * tau_c / (2 * fracture_energy)};
}

using CrackPlan = StudyPlan<CrackRow>;
using RunOne = std::function<Torn(int)>;

// One ensemble; `seconds` guesses one run.
void add(StudySize size, CrackRow row, Real seconds, const RunOne& run, CrackPlan& plan) {
  const int runs = size == StudySize::smallest ? 2 : 8;
  plan.add(runs * seconds, [=]() mutable {
    std::vector<Torn> torn;
    for (int n = 0; n < runs; ++n) torn.push_back(run(n));
    fill_spreads(row, torn);
    return row;
  });
}

// What is left to chance between the runs of an ensemble.
enum class Varied { shift, turn, tets, direction, seed };
constexpr const char* kVaried[] = {"grid shift", "grid rotation", "mesh", "direction", "seed"};

Real eighth_turn(int n) { return 45.0 * n / 7; }

Torn tear_bar_number(BarRun run, Varied varied, int n) {
  run.shift = n;
  if (varied == Varied::turn) run.turn = eighth_turn(n);
  if (varied == Varied::direction) run.pull_angle = eighth_turn(n);
  if (varied == Varied::tets) run.tets = BarTets::delaunay;
  return tear_bar(run);
}

void study_bars(StudySize size, CrackPlan& plan) {
  const std::vector<Real> all =
      size == StudySize::smallest ? std::vector<Real>{0.4} : std::vector<Real>{0.4, 0.2, 0.1};
  for (bool mesh : {true, false})
    for (bool by_energy : {false, true})
      for (Varied varied : {Varied::shift, Varied::turn, Varied::direction, Varied::tets}) {
        if (varied != Varied::shift && (size != StudySize::full || !by_energy)) continue;
        if (!mesh && varied != Varied::shift && varied != Varied::turn) continue;
        for (Real dx : all) {
          if (!mesh && size != StudySize::full && dx < 0.2) continue;
          if (varied == Varied::tets && dx < 0.4) continue;  // slivers take short steps
          if (varied != Varied::shift && dx < 0.2) continue;
          BarRun run;
          run.dx = dx;
          run.mesh_force = mesh;
          run.particles_per_cell = mesh ? 2 : 8;
          run.softening = laws(bar_energy(mesh), kBarStrength, all[0], mesh).text(by_energy);
          run.solver =
              method(Transfer::apic, Kernel::quadratic, ForceForm::mls, Precision::float32);
          run.with_fracture_mesh = true;
          CrackRow row;
          row.body = "bar";
          row.law = by_energy ? "fracture_energy" : "alpha";
          row.force = mesh ? "mesh" : "particle";
          row.varied = kVaried[static_cast<int>(varied)];
          row.dx = dx;
          const Real scale = 0.1 / dx;
          const Real seconds = varied == Varied::tets ? 60 : mesh ? 3 : 0.8;
          add(
              size, row, seconds * scale * scale,
              [=](int n) { return tear_bar_number(run, varied, n); }, plan);
        }
      }
}

void study_notched_bars(StudySize size, const std::filesystem::path& scenes, CrackPlan& plan) {
  const std::vector<Real> all = size == StudySize::smallest ? std::vector<Real>{0.216}
                                : size == StudySize::quick  ? std::vector<Real>{0.216, 0.153}
                                                           : std::vector<Real>{0.216, 0.153, 0.108};
  // Particle forces can resolve it: 0.8 tau_c dx is 690 J/m2 at the finest dx.
  const Real tau_c = 8000, energy = 500;
  for (bool mesh : {false, true})
    for (bool by_energy : {false, true})
      for (Varied varied : {Varied::seed, Varied::shift, Varied::turn}) {
        const bool seeds = varied == Varied::seed;
        // Meshes of bodies with mesh forces are a lattice without chance.
        if (size == StudySize::smallest ? mesh || !seeds : mesh && varied != Varied::shift)
          continue;
        // A grid that is moved or turned changes both laws alike.
        if (!seeds && !mesh && !by_energy) continue;
        for (Real dx : all) {
          if (!seeds && dx < (size == StudySize::full ? 0.15 : 0.2)) continue;
          NotchRun run;
          run.dx = dx;
          run.mesh_force = mesh;
          run.softening = laws(energy, tau_c, all[0], mesh).text(by_energy);
          CrackRow row;
          row.body = "notched bar";
          row.law = by_energy ? "fracture_energy" : "alpha";
          row.force = mesh ? "mesh" : "particle";
          row.varied = kVaried[static_cast<int>(varied)];
          row.dx = dx;
          const auto number = [=](int n) {
            NotchRun one = run;
            if (varied == Varied::seed) one.seed = n + 1;
            if (varied == Varied::shift) one.shift = n + 1;
            if (varied == Varied::turn) one.turn = eighth_turn(n);
            return tear_notched_bar(scenes, one);
          };
          add(size, row, (mesh ? 3.0 : 0.6) * std::pow(0.216 / dx, 4), number, plan);
        }
      }
}

std::string plus_minus(const Spread& s, int digits) {
  return fmt::format("{:.{}f} +- {:.{}f}", s.mean, digits, s.deviation, digits);
}

std::string crack_table(const std::vector<CrackRow>& rows) {
  std::string out =
      "| body | forces | law | varied | dx | particles | runs | dissipated | crack area | pieces | "
      "peak force |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const CrackRow& r : rows) {
    const bool bar = r.body == "bar";
    out += fmt::format("| {} | {} | {} | {} | {:g} | {} | {} | {} | {} | {} | {} |\n", r.body,
                       r.force, r.law, r.varied, r.dx, r.particles, r.runs - r.failed,
                       plus_minus(r.dissipated, bar ? 3 : 0), plus_minus(r.crack_area, 2),
                       plus_minus(r.pieces, 0), plus_minus(r.peak_force, bar ? 2 : 0));
  }
  out +=
      "\n| body | forces | law | varied | dx | dissipated, finest over coarsest | d ln D / d ln "
      "dx |\n|---|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const CrackRow& first = rows[i];
    if (i > 0 && same_study(rows[i - 1], first)) continue;
    std::size_t last = i;
    while (last + 1 < rows.size() && same_study(rows[last + 1], first)) ++last;
    if (last == i) continue;
    out +=
        fmt::format("| {} | {} | {} | {} | {:g} to {:g} | {:.2f} | {:.2f} |\n", first.body,
                    first.force, first.law, first.varied, first.dx, rows[last].dx,
                    rows[last].dissipated.mean / first.dissipated.mean, energy_slope(rows, first));
  }
  return out;
}

LogPlot crack_plot(const std::vector<CrackRow>& rows) {
  LogPlot plot;
  plot.name = "cracks_energy";
  plot.title = "What a crack dissipates against the size of cells";
  plot.subtitle = "Mean and standard deviation of eight runs, over the mean at the largest dx";
  plot.x_label = "dx over the largest dx";
  plot.y_label = "dissipated energy";
  const CrackRow* first = nullptr;
  for (const CrackRow& row : rows) {
    const bool bar = row.body == "bar";
    if (row.varied != (bar || row.force == "mesh" ? "grid shift" : "seed")) continue;
    if (!first || !same_study(*first, row)) {
      first = &row;
      PlotSeries series;
      const bool by_energy = row.law == "fracture_energy", mesh = row.force == "mesh";
      series.label = fmt::format("{}, {}, {}", row.body, mesh ? "mesh" : "particle",
                                 by_energy ? "G" : "alpha");
      series.color = by_energy ? (bar ? 0x2166ac : 0x5aa9a3) : (bar ? 0xc0504d : 0xd98c3f);
      series.dashed = !mesh;
      series.marker = mesh ? Marker::diamond : Marker::disc;
      plot.series.push_back(series);
    }
    const Real unit = first->dissipated.mean, mean = row.dissipated.mean / unit,
               deviation = row.dissipated.deviation / unit;
    plot.series.back().points.push_back(
        {row.dx / first->dx, mean, std::max(mean - deviation, 0.01 * mean), mean + deviation});
  }
  plot.guides = {{"objective", 0, 1, 1}, {"follows dx", 1, 1, 1}};
  return plot;
}

}  // namespace

StudyOutput bench_cracks(StudySize size, const std::filesystem::path& scenes, std::FILE* progress) {
  CrackPlan plan;
  study_bars(size, plan);
  study_notched_bars(size, scenes, plan);
  const std::vector<CrackRow> rows = plan.run_all(progress, [](const CrackRow& row) {
    return fmt::format("{:12} {:9} {:16} {:14} dx {:6.3g}: dissipated {:.4g} +- {:.2g}, {:.3g} s",
                       row.body, row.force, row.law, row.varied, row.dx, row.dissipated.mean,
                       row.dissipated.deviation, row.cpu_seconds);
  });
  return {crack_table(rows), crack_csv(rows), {crack_plot(rows)}};
}

}  // namespace rend
