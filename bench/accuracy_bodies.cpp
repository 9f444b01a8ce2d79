// P2 to P6: bodies that turn, collide, yield, tear and flatten.
#include "bench/accuracy_problems.h"
#include "bench/problems/driven_block.h"
#include "bench/problems/method.h"
#include "bench/problems/round_bodies.h"
#include "bench/problems/taylor_bar.h"
#include "bench/problems/torn_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

Real budget_of(StudySize size) {
  return size == StudySize::smallest ? 0 : 0.2;
}

// Cells in a radius; a run takes their fourth power.
std::vector<int> cells_of(StudySize size, const SolverDesc& solver, int finest) {
  if (size == StudySize::smallest) return {2};
  if (size == StudySize::quick) return {2, 3};
  const bool tile = solver.precision == Precision::float32;
  // Of the reference only the schemes that may win are refined further.
  const bool good = solver.transfer == Transfer::apic ||
                    (solver.transfer == Transfer::flip && solver.flip_ratio == 1);
  std::vector<int> out;
  for (int cells : {2, 3, 4, 6, 8})
    if (cells <= (tile ? 8 : good ? finest : 3)) out.push_back(cells);
  return out;
}

// What bodies that turn or collide are run with.
std::vector<SolverDesc> body_methods(StudySize size) {
  if (size == StudySize::smallest)
    return {method(Transfer::apic),
            method(Transfer::apic, Kernel::quadratic, ForceForm::mls, Precision::float32)};
  std::vector<SolverDesc> out = studied_methods(Kernel::quadratic, ForceForm::gradient);
  for (Real ratio : {0.95, 0.99}) {
    out.push_back(method(Transfer::flip, Kernel::quadratic, ForceForm::gradient));
    out.back().flip_ratio = ratio;
  }
  out.push_back(method(Transfer::rpic, Kernel::quadratic, ForceForm::gradient));
  if (size == StudySize::full)
    for (Transfer transfer : {Transfer::flip, Transfer::apic})
      out.push_back(method(transfer, Kernel::cubic, ForceForm::gradient));
  out.push_back(method(Transfer::apic));
  for (const SolverDesc& solver : tile_methods()) out.push_back(solver);
  return out;
}

using RoundProblem = RoundResult (*)(const SolverDesc&, const RoundRun&);

AccuracyRow round_row(const char* problem, const SolverDesc& solver, const RoundRun& run,
                      Real radius, Real budget, const RoundProblem& run_body) {
  AccuracyRow row;
  row.problem = problem;
  row.solver = solver;
  row.cells = run.cells;
  row.dx = radius / run.cells;
  row.courant = run.courant;
  RoundResult result;
  repeat(row, budget, [&] {
    result = run_body(solver, run);
    return result.cost;
  });
  if (row.cost.status == Status::ok) {
    row.error = row.drift_energy = std::abs(result.energy - 1);
    row.drift_spin = std::abs(result.spin);
    row.drift_momentum = result.momentum;
  }
  return row;
}

// `steps` of a run of one cell in a radius, and how many radii of matter there are.
void study_round(StudySize size, const char* problem, Real radius, int finest, Real steps,
                 Real bodies, const RoundProblem& run_body, AccuracyPlan& plan) {
  for (const SolverDesc& solver : body_methods(size))
    for (int cells : cells_of(size, solver, finest)) {
      RoundRun run;
      run.thin = false;
      run.cells = cells;
      const Real particles = bodies * 8 * 4.2 * std::pow(cells, 3), budget = budget_of(size);
      plan.add(std::max(budget, particles * steps * cells * guessed_seconds(solver)),
               [=] { return round_row(problem, solver, run, radius, budget, run_body); });
    }
}

AccuracyRow driven_row(const SolverDesc& solver, SofteningRule rule, DrivenPath path, Index steps) {
  AccuracyRow row;
  row.problem = path == DrivenPath::uniaxial_strain ? "driven_rankine" : "driven_von_mises";
  row.solver = solver;
  row.rule = rule;
  row.cells = static_cast<int>(steps);
  row.dx = 1;
  DrivenResult result;
  repeat(row, 0, [&] {
    result = drive(solver, rule, path, steps);
    return result.cost;
  });
  row.error = row.error_tau = result.stress;
  row.drift_energy = result.dissipation;
  row.y_max = result.excess;
  row.dissipation_min = result.least_work;
  return row;
}

AccuracyRow rupture_row(const BarRun& run, Real budget) {
  const Real stress = kBarStrength * std::exp(-kBarStrength / 100);  // force over rest section
  AccuracyRow row;
  row.problem = "torn_bar";
  row.solver = run.solver;
  row.force = run.mesh_force ? ForceKind::mesh : ForceKind::particle;
  row.cells = static_cast<int>(std::lround(8 / run.dx));
  row.dx = run.dx;
  row.particles_per_cell = run.particles_per_cell;
  Torn bar;
  repeat(row, budget, [&] {
    bar = tear_bar(run);
    return bar.cost;
  });
  if (row.cost.status == Status::ok) {
    row.dissipated = bar.dissipated / bar_energy(run.mesh_force);
    row.peak = bar.peak_force / stress;
    row.error = row.drift_energy = std::abs(row.dissipated - 1);
  }
  return row;
}

AccuracyRow impact_row(const SolverDesc& solver, int cells, const std::filesystem::path& scenes) {
  AccuracyRow row;
  row.problem = "taylor_bar";
  row.solver = solver;
  row.cells = cells;
  row.dx = kTaylorRadius / cells;
  TaylorShape shape;
  repeat(row, 0, [&] {
    shape = strike_wall(scenes, row.dx, solver);
    return shape.cost;
  });
  if (row.cost.status == Status::ok) {
    row.length = shape.length / kTaylorLength;
    row.radius = shape.foot / kTaylorFoot;
    row.error = 0.5 * (std::abs(row.length - 1) + std::abs(row.radius - 1));
  }
  return row;
}

}  // namespace

void study_turning(StudySize size, AccuracyPlan& plan) {
  const auto eighth = [](const SolverDesc& solver, const RoundRun& run) {
    return turn(solver, 0.125, run);
  };
  study_round(size, "turning_ball", 1, 4, 96, 1, eighth, plan);
}

void study_collision(StudySize size, AccuracyPlan& plan) {
  study_round(size, "colliding_balls", 0.4, 4, 275, 2, bounce, plan);
}

void study_driven(StudySize size, AccuracyPlan& plan) {
  for (DrivenPath path : {DrivenPath::uniaxial_strain, DrivenPath::pure_shear})
    for (SofteningRule rule : {SofteningRule::implicit_rule, SofteningRule::explicit_rule})
      for (DeformationUpdate update : {DeformationUpdate::exponential, DeformationUpdate::linear})
        for (Precision precision : {Precision::float64, Precision::float32}) {
          SolverDesc solver = method(Transfer::apic, Kernel::quadratic, ForceForm::mls, precision);
          solver.deformation_update = update;
          const bool linear = update == DeformationUpdate::linear;
          if (linear && precision == Precision::float32) continue;
          for (Index steps : {20, 80, 320, 1280}) {
            if (steps > (size == StudySize::full ? 1280 : size == StudySize::quick ? 320 : 20))
              break;
            plan.add(64 * 2e-6 * static_cast<Real>(steps),
                     [=] { return driven_row(solver, rule, path, steps); });
          }
        }
}

void study_rupture(StudySize size, AccuracyPlan& plan) {
  const auto sweep = [&](const SolverDesc& solver, bool mesh, Real finest) {
    for (Real dx : {0.4, 0.2, 0.1}) {
      if (dx < finest * 0.99) break;
      BarRun run;
      run.dx = dx;
      run.mesh_force = mesh;
      run.softening = fmt::format("\"fracture_energy\": {}", bar_energy(mesh));
      run.solver = solver;
      if (!mesh) run.particles_per_cell = 8;
      const Real particles = 72 / dx * run.particles_per_cell, steps = 250 / dx;
      const Real seconds =
          particles * steps * guessed_seconds(solver, mesh ? ForceKind::mesh : ForceKind::particle);
      const Real budget = budget_of(size);
      plan.add(std::max(seconds, budget), [=] { return rupture_row(run, budget); });
    }
  };
  const SolverDesc apic = method(Transfer::apic);
  SolverDesc tile = apic;
  tile.precision = Precision::float32;
  if (size == StudySize::smallest) return sweep(tile, true, 0.4);
  const bool full = size == StudySize::full;
  for (const SolverDesc& solver : tile_methods())
    for (bool mesh : {true, false}) sweep(solver, mesh, full ? 0.1 : 0.2);
  for (bool mesh : {true, false}) sweep(apic, mesh, full ? 0.2 : 0.4);
  if (!full) return;
  for (const SolverDesc& solver : {method(Transfer::flip), method(Transfer::apic, Kernel::cubic)})
    for (bool mesh : {true, false}) sweep(solver, mesh, 0.4);
}

void study_impact(StudySize size, const std::filesystem::path& scenes, AccuracyPlan& plan) {
  if (size == StudySize::smallest) return;
  const auto sweep = [&](const SolverDesc& solver, std::initializer_list<int> cells) {
    for (int n : cells) {
      const Real particles = 255 * std::pow(n, 3), steps = 330 * n;
      plan.add(particles * steps * guessed_seconds(solver),
               [=] { return impact_row(solver, n, scenes); });
    }
  };
  const bool full = size == StudySize::full;
  for (const SolverDesc& solver : tile_methods()) {
    if (!full)
      sweep(solver, {3});
    else if (solver.transfer == Transfer::apic)
      sweep(solver, {3, 4, 6, 8});
    else
      sweep(solver, {3, 4});
  }
  if (full) sweep(method(Transfer::apic), {3});
}

}  // namespace rend
