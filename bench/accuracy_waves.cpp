// P1: a manufactured wave.
#include "bench/accuracy_problems.h"
#include "bench/problems/manufactured_wave.h"
#include "bench/problems/method.h"
#include "engine/mpm/tile_solver.h"

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

// Displacements in units of dx where the study calls a wave large: particles cross cells.
constexpr Real kSmall = 4e-3, kLarge = 0.05;

AccuracyRow wave_row(const char* problem, const SolverDesc& solver, const WaveRun& run,
                     Real budget) {
  AccuracyRow row;
  row.problem = problem;
  row.solver = solver;
  row.force = run.mesh ? ForceKind::mesh : ForceKind::particle;
  row.cells = run.cells;
  row.dx = 1.0 / run.cells;
  row.particles_per_cell = std::pow(run.per_axis, run.thin ? 1 : 3);
  row.courant = run.courant;
  const WaveErrors e = run_wave(solver, run);
  row.cost = e.cost;
  if (e.cost.status != Status::ok) return row;
  // The clock sees fewer steps than the run, and none of its rule.
  const Real steps = static_cast<Real>(e.cost.steps);
  const Index timed = std::min<Index>(e.cost.steps, 20);
  repeat(row, budget, [&] {
    RunCost cost = time_wave(solver, run, timed);
    const Real share = steps / static_cast<Real>(cost.steps);
    cost.cpu_seconds *= share;
    cost.wall_seconds *= share;
    cost.steps = e.cost.steps;
    return cost;
  });
  row.error = row.error_u = e.u;
  row.error_v = e.v;
  if (!run.mesh) row.error_tau = e.tau;
  return row;
}

WaveRun cube(int cells, Real amplitude) {
  WaveRun run;
  run.thin = false;
  run.cells = cells;
  run.amplitude = amplitude;
  run.duration = 0.5;
  return run;
}

SolverDesc as_float(SolverDesc solver) {
  solver.precision = Precision::float32;
  return solver;
}

// CPU time of a run and of the clock's. The rule of the solution costs about a microsecond a node.
Real wave_seconds(const SolverDesc& solver, const WaveRun& run, Real budget) {
  const Real edge = run.cells + 4, dimension = run.thin ? 1 : 3;
  const Real steps = run.duration * 1.2 * run.cells / run.courant;
  const Real particles = std::pow(edge * run.per_axis, dimension);
  const Real step =
      particles * guessed_seconds(solver, run.mesh ? ForceKind::mesh : ForceKind::particle);
  return steps * (step + 1e-6 * std::pow(edge, dimension) * (run.thin ? 9 : 1)) +
         std::max(budget, 20 * step);
}

AccuracyRow rounding_row(const char* problem, const SolverDesc& exact, const WaveRun& run) {
  AccuracyRow row = wave_row(problem, as_float(exact), run, 0);
  const std::vector<Real> a = run_wave(exact, run).last, b = run_wave(as_float(exact), run).last;
  Real sum = 0;
  for (std::size_t p = 0; p < a.size(); ++p) sum += (a[p] - b[p]) * (a[p] - b[p]);
  row.rounding = std::sqrt(sum / static_cast<Real>(a.size())) / run.amplitude;
  return row;
}

// Float and double side by side until rounding shows.
void refine_column(StudySize size, Real amplitude, AccuracyPlan& plan) {
  const int finest = size == StudySize::full ? 256 : size == StudySize::quick ? 64 : 16;
  WaveRun run;
  run.amplitude = amplitude;
  const char* problem = amplitude < 1e-3 ? "column_1e-4" : "column_4e-3";
  const SolverDesc exact = method(Transfer::apic);
  for (run.cells = 16; run.cells <= finest; run.cells *= 2) {
    const Real seconds = wave_seconds(exact, run, 0);
    plan.add(seconds, [=] { return wave_row(problem, exact, run, 0); });
    plan.add(3 * seconds, [=] { return rounding_row(problem, exact, run); });
  }
}

}  // namespace

Real guessed_seconds(const SolverDesc& solver, ForceKind force) {
  if (solver.precision == Precision::float32) return force == ForceKind::mesh ? 350e-9 : 45e-9;
  Real out = force == ForceKind::mesh ? 6e-6 : 1.3e-6;
  if (solver.kernel == Kernel::cubic) out *= 2;
  if (solver.transfer == Transfer::polypic || solver.transfer == Transfer::xpic) out *= 1.5;
  return out;
}

std::vector<SolverDesc> studied_methods(Kernel kernel, ForceForm form) {
  std::vector<SolverDesc> out;
  for (Transfer transfer :
       {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::polypic, Transfer::xpic})
    out.push_back(method(transfer, kernel, form));
  return out;
}

std::vector<SolverDesc> tile_methods() {
  std::vector<SolverDesc> out;
  for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::rpic, Transfer::apic}) {
    SceneDesc scene;
    scene.solver = as_float(method(transfer));
    if (TileSolver::obstacle(scene).empty()) out.push_back(scene.solver);
  }
  return out;
}

void study_waves(StudySize size, AccuracyPlan& plan) {
  const Real budget = size == StudySize::full ? 0.2 : 0.1;
  if (size == StudySize::smallest) {
    for (int cells : {4, 6})
      for (const SolverDesc& solver : {method(Transfer::apic), as_float(method(Transfer::apic))})
        plan.add(1, [=] { return wave_row("wave", solver, cube(cells, kSmall), 0); });
    refine_column(size, kSmall, plan);
    return;
  }
  const bool full = size == StudySize::full;
  const auto sweep = [&](const char* problem, Real amplitude, const SolverDesc& solver,
                         std::initializer_list<int> cells, int most, int per_axis = 2,
                         bool mesh = false, Real courant = 0.2) {
    for (int n : cells) {
      if (n > most) break;
      WaveRun run = cube(n, amplitude);
      run.per_axis = per_axis;
      run.mesh = mesh;
      run.courant = courant;
      plan.add(wave_seconds(solver, run, budget),
               [=] { return wave_row(problem, solver, run, budget); });
    }
  };
  const SolverDesc apic = method(Transfer::apic);
  for (const SolverDesc& solver : studied_methods(Kernel::quadratic, ForceForm::mls))
    sweep("wave", kSmall, solver, {6, 8, 12, 24},
          !full                               ? 8
          : solver.transfer == Transfer::apic ? 24
                                              : 12);
  if (full)
    for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic})
      for (Kernel kernel : {Kernel::quadratic, Kernel::cubic})
        if (transfer != Transfer::pic || kernel == Kernel::cubic)
          sweep("wave", kSmall, method(transfer, kernel, ForceForm::gradient), {6, 8, 12}, 12);
  for (const SolverDesc& solver : tile_methods())
    sweep("wave", kSmall, solver, {6, 8, 12, 24, 48},
          !full                               ? 12
          : solver.transfer == Transfer::apic ? 48
                                              : 24);
  // Particles a cell, mesh forces and the step.
  for (int per_axis : {1, 3})
    sweep("wave", kSmall, as_float(apic), {6, 12, 24}, full ? 24 : 12, per_axis);
  for (Precision precision : {Precision::float64, Precision::float32}) {
    SolverDesc solver = apic;
    solver.precision = precision;
    const bool fine = precision == Precision::float32;
    sweep("wave", kSmall, solver, {6, 12}, full || fine ? 12 : 6, 2, true);
  }
  for (Real courant : {0.1, 0.4, 0.8})
    sweep("wave", kSmall, as_float(apic), {6, 12, 24}, full ? 24 : 12, 2, false, courant);
  // Large strains: particles cross cells.
  for (int per_axis : {2, 3, 4})
    sweep("large_wave", kLarge, as_float(apic), {6, 12, 24}, full ? 24 : 12, per_axis);
  if (full) {
    for (Kernel kernel : {Kernel::quadratic, Kernel::cubic})
      for (Transfer transfer : {Transfer::flip, Transfer::apic})
        sweep("large_wave", kLarge, method(transfer, kernel), {6, 12, 24}, 12);
    sweep("large_wave", kLarge, as_float(apic), {6, 12}, 12, 2, true);
  }
  for (Real amplitude : {1e-4, kSmall}) refine_column(size, amplitude, plan);
}

}  // namespace rend
