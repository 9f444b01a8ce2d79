// The study as a whole, and what it says in figures.
#include "bench/bench_accuracy.h"

#include "bench/problems/method.h"
#include "engine/core/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

std::string full_name(const AccuracyRow& row) {
  std::string name = method_name(row.solver);
  if (row.force == ForceKind::mesh) name += ", mesh forces";
  if (row.solver.deformation_update == DeformationUpdate::linear) name += ", linear update";
  if (row.rule == SofteningRule::explicit_rule) name += ", explicit softening";
  return name;
}

std::vector<std::string> problems_of(const std::vector<AccuracyRow>& rows) {
  std::vector<std::string> out;
  for (const AccuracyRow& row : rows)
    if (std::find(out.begin(), out.end(), row.problem) == out.end()) out.push_back(row.problem);
  return out;
}

std::string step_text(const AccuracyRow& row) {
  return std::isfinite(row.courant) ? fmt::format("{:g}", row.courant) : "cfl";
}

std::string front_table(const std::vector<AccuracyRow>& rows, const std::string& problem) {
  std::vector<PlotPoint> points;
  for (const AccuracyRow& row : rows)
    if (row.problem == problem) points.push_back({row.cost.cpu_seconds, row.error, 0, 0});
  std::string out;
  for (const PlotPoint& p : pareto_front(points))
    for (const AccuracyRow& row : rows)
      if (row.problem == problem && row.cost.cpu_seconds == p.x && row.error == p.y) {
        out += fmt::format("| {} | {} | {} | {:g} | {} | {:.3g} | {:.0f} | {:.2e} |\n", problem,
                           full_name(row), row.cells, row.particles_per_cell, step_text(row),
                           row.cost.cpu_seconds, row.ns_per_particle_step(), row.error);
        break;
      }
  return out;
}

// The tile solver against the reference with the same method, over the errors that both reach.
std::string speed_at_equal_error(const std::vector<AccuracyRow>& rows) {
  std::string out;
  std::vector<AccuracyRow> seen;
  for (const AccuracyRow& tile : rows) {
    if (tile.solver.precision != Precision::float32 || !(tile.error > 0)) continue;
    if (std::any_of(seen.begin(), seen.end(),
                    [&](const AccuracyRow& s) { return s.same_method(tile); }))
      continue;
    seen.push_back(tile);
    AccuracyRow reference = tile;
    reference.solver.precision = Precision::float64;
    Real least = 1e300, most = 0, low = 1e300, high = 0;
    for (const AccuracyRow& row : rows) {
      if (!row.same_method(reference) && !row.same_method(tile)) continue;
      const Real ratio =
          cost_at_error(rows, reference, row.error) / cost_at_error(rows, tile, row.error);
      if (!std::isfinite(ratio)) continue;
      least = std::min(least, ratio), most = std::max(most, ratio);
      low = std::min(low, row.error), high = std::max(high, row.error);
    }
    if (most > 0)
      out += fmt::format("| {} | {} | {:g} | {:.1e} to {:.1e} | {:.1f} to {:.1f} |\n", tile.problem,
                         full_name(reference), tile.particles_per_cell, low, high, least, most);
  }
  return out;
}

std::string rounding_table(const std::vector<AccuracyRow>& rows) {
  std::string out;
  for (const AccuracyRow& row : rows) {
    if (!std::isfinite(row.rounding)) continue;
    const auto exact = std::find_if(rows.begin(), rows.end(), [&](const AccuracyRow& r) {
      return r.problem == row.problem && r.cells == row.cells &&
             r.solver.precision == Precision::float64;
    });
    out += fmt::format("| {} | {} | {:.1e} | {:.1e} | {:.1e} |\n", row.problem, row.cells,
                       exact->error, row.error, row.rounding);
  }
  return out;
}

}  // namespace

std::string accuracy_table(const std::vector<AccuracyRow>& rows) {
  std::string out =
      "Pareto fronts: no other run has a smaller error in less time.\n\n"
      "| problem | method | cells | particles a cell | dt c_p / dx | CPU s | ns per particle and "
      "step "
      "| error |\n|---|---|---|---|---|---|---|---|\n";
  for (const std::string& problem : problems_of(rows)) out += front_table(rows, problem);
  out +=
      "\nThe tile solver against the reference at equal error, the same method.\n\n"
      "| problem | method | particles a cell | errors | times faster |\n|---|---|---|---|---|\n" +
      speed_at_equal_error(rows);
  out +=
      "\nWhere float ends: error of the displacement, and the part that is rounding.\n\n"
      "| problem | cells | double | float | rounding |\n|---|---|---|---|---|\n" +
      rounding_table(rows);
  return out;
}

StudyOutput bench_accuracy(StudySize size, const std::filesystem::path& scenes,
                           std::FILE* progress) {
  AccuracyPlan plan;
  study_waves(size, plan);
  study_turning(size, plan);
  study_collision(size, plan);
  study_driven(size, plan);
  study_rupture(size, plan);
  study_impact(size, scenes, plan);
  set_thread_count(1);
  const std::vector<AccuracyRow> rows = plan.run_all(progress, [](const AccuracyRow& row) {
    return fmt::format("{:16} {:44} {:4} cells {:3.0f} a cell: {:8.3g} s, error {:.2e} {}",
                       row.problem, full_name(row), row.cells, row.particles_per_cell,
                       row.cost.cpu_seconds, row.error,
                       row.cost.status == Status::ok ? "" : status_name(row.cost.status));
  });
  set_thread_count(0);
  return {accuracy_table(rows), accuracy_csv(rows), accuracy_plots(rows)};
}

}  // namespace rend
