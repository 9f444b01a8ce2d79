// Rows to CSV, repeats, curves.
#include "bench/accuracy_row.h"

#include "bench/problems/method.h"
#include "bench/run_counters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

struct Column {
  const char* name;
  std::function<std::string(const AccuracyRow&)> text;
};

std::string number(Real value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : ""; }

std::vector<Column> columns() {
  using Row = const AccuracyRow&;
  std::vector<Column> out = {
      {"version", [](Row) { return std::string(REND_VERSION); }},
      {"problem", [](Row r) { return r.problem; }},
      {"transfer", [](Row r) { return transfer_name(r.solver); }},
      {"kernel", [](Row r) { return r.solver.kernel == Kernel::cubic ? "cubic" : "quadratic"; }},
      {"force_form",
       [](Row r) { return r.solver.force_form == ForceForm::mls ? "mls" : "gradient"; }},
      {"force", [](Row r) { return r.force == ForceKind::mesh ? "mesh" : "particle"; }},
      {"deformation_update",
       [](Row r) {
         const bool linear = r.solver.deformation_update == DeformationUpdate::linear;
         return linear ? "linear" : "exponential";
       }},
      {"softening_rule",
       [](Row r) { return r.rule == SofteningRule::explicit_rule ? "explicit" : "implicit"; }},
      {"solver",
       [](Row r) { return r.solver.precision == Precision::float32 ? "tile" : "reference"; }},
      {"precision",
       [](Row r) { return r.solver.precision == Precision::float32 ? "float" : "double"; }},
      {"cells", [](Row r) { return std::to_string(r.cells); }},
      {"status", [](Row r) { return std::string(status_name(r.cost.status)); }}};
  const auto add = [&](const char* name, std::function<Real(Row)> value) {
    out.push_back({name, [value](Row r) { return number(value(r)); }});
  };
  add("dx", [](Row r) { return r.dx; });
  add("particles_per_cell", [](Row r) { return r.particles_per_cell; });
  add("courant", [](Row r) { return r.courant; });
  add("particles", [](Row r) { return static_cast<Real>(r.cost.particles); });
  add("steps", [](Row r) { return static_cast<Real>(r.cost.steps); });
  add("repeats", [](Row r) { return r.repeats; });
  add("cpu_s", [](Row r) { return r.cost.cpu_seconds; });
  add("cpu_s_min", [](Row r) { return r.cpu_seconds_min; });
  add("wall_s", [](Row r) { return r.cost.wall_seconds; });
  add("wall_s_min", [](Row r) { return r.wall_seconds_min; });
  add("instructions", [](Row r) { return r.instructions; });
  add("peak_rss", [](Row r) { return r.peak_memory; });
  add("ns_per_particle_step", [](Row r) { return r.ns_per_particle_step(); });
  add("particle_steps_per_s", [](Row r) { return 1e9 / r.ns_per_particle_step(); });
  add("bytes_per_particle", [](Row r) { return r.cost.bytes_per_particle; });
  add("error", [](Row r) { return r.error; });
  add("error_u", [](Row r) { return r.error_u; });
  add("error_v", [](Row r) { return r.error_v; });
  add("error_tau", [](Row r) { return r.error_tau; });
  add("rounding", [](Row r) { return r.rounding; });
  add("drift_energy", [](Row r) { return r.drift_energy; });
  add("drift_momentum", [](Row r) { return r.drift_momentum; });
  add("drift_spin", [](Row r) { return r.drift_spin; });
  add("y_max", [](Row r) { return r.y_max; });
  add("dissipation_min", [](Row r) { return r.dissipation_min; });
  add("dissipated", [](Row r) { return r.dissipated; });
  add("peak_force", [](Row r) { return r.peak; });
  add("length", [](Row r) { return r.length; });
  add("radius", [](Row r) { return r.radius; });
  return out;
}

Real median(std::vector<Real> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace

bool AccuracyRow::same_method(const AccuracyRow& other) const {
  SolverDesc a = solver, b = other.solver;
  a.time_step = b.time_step = 0;
  const bool same_step =
      courant == other.courant || (courant != courant && other.courant != other.courant);
  return problem == other.problem && a == b && force == other.force && rule == other.rule &&
         same_step && particles_per_cell == other.particles_per_cell;
}

std::string accuracy_csv(const std::vector<AccuracyRow>& rows) {
  const std::vector<Column> all = columns();
  std::string out;
  for (const Column& c : all) out += (&c == &all.front() ? "" : ",") + std::string(c.name);
  for (const AccuracyRow& row : rows) {
    out += '\n';
    for (const Column& c : all) out += (&c == &all.front() ? "" : ",") + c.text(row);
  }
  return out + '\n';
}

void repeat(AccuracyRow& row, Real budget, const std::function<RunCost()>& run) {
  std::vector<Real> cpu, wall;
  Real used = 0;
  do {
    const RunCounters counters;
    row.cost = run();
    row.instructions = counters.instructions();
    row.peak_memory = counters.peak_memory();
    cpu.push_back(row.cost.cpu_seconds);
    wall.push_back(row.cost.wall_seconds);
    used += cpu.back();
  } while (used + cpu.back() < budget && cpu.size() < 5);
  row.repeats = static_cast<int>(cpu.size());
  row.cpu_seconds_min = *std::min_element(cpu.begin(), cpu.end());
  row.wall_seconds_min = *std::min_element(wall.begin(), wall.end());
  row.cost.cpu_seconds = median(cpu);
  row.cost.wall_seconds = median(wall);
}

Real cost_at_error(const std::vector<AccuracyRow>& rows, const AccuracyRow& method, Real error) {
  const AccuracyRow* before = nullptr;
  for (const AccuracyRow& row : rows) {
    if (!row.same_method(method) || !(row.error > 0)) continue;
    if (before && row.error <= error && error <= before->error) {
      const Real t = std::log(error / before->error) / std::log(row.error / before->error);
      return std::exp((1 - t) * std::log(before->cost.cpu_seconds) +
                      t * std::log(row.cost.cpu_seconds));
    }
    before = &row;
  }
  return kNotMeasured;
}

}  // namespace rend
