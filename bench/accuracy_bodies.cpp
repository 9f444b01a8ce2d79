// P2 to P6: bodies that turn, collide, yield, tear and flatten.
#include "bench/accuracy_problems.h"
#include "bench/problems/driven_block.h"
#include "bench/problems/method.h"
#include "bench/problems/round_bodies.h"
#include "bench/problems/taylor_bar.h"
#include "bench/problems/torn_body.h"

#include <cmath>

namespace rend {

namespace {

Real budget_of(StudySize size) {
  return size == StudySize::full ? 0.5 : size == StudySize::quick ? 0.2 : 0;
}

// Cells in a radius; a run takes their fourth power.
std::vector<int> cells_of(StudySize size, const SolverDesc& solver, int finest) {
  if (size == StudySize::smallest) return {2};
  if (size == StudySize::quick) return {2, 3};
  const bool tile = solver.precision == Precision::float32;
  std::vector<int> out;
  for (int cells : {2, 3, 4, 6, 8})
    if (cells <= (tile ? 8 : finest)) out.push_back(cells);
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

void study_round(StudySize size, const char* problem, Real radius, int finest,
                 const RoundProblem& run_body, const RowSink& done) {
  for (const SolverDesc& solver : body_methods(size))
    for (int cells : cells_of(size, solver, finest)) {
      RoundRun run;
      run.thin = false;
      run.cells = cells;
      AccuracyRow row;
      row.problem = problem;
      row.solver = solver;
      row.cells = cells;
      row.dx = radius / cells;
      row.courant = run.courant;
      RoundResult result;
      repeat(row, budget_of(size), [&] {
        result = run_body(solver, run);
        return result.cost;
      });
      if (row.cost.status == Status::ok) {
        row.error = row.drift_energy = std::abs(result.energy - 1);
        row.drift_spin = std::abs(result.spin);
        row.drift_momentum = result.momentum;
      }
      done(row);
    }
}

}  // namespace

void study_turning(StudySize size, const RowSink& done) {
  const auto eighth = [](const SolverDesc& solver, const RoundRun& run) {
    return turn(solver, 0.125, run);
  };
  study_round(size, "turning_ball", 1, 4, eighth, done);
}

void study_collision(StudySize size, const RowSink& done) {
  study_round(size, "colliding_balls", 0.4, 4, bounce, done);
}

void study_driven(StudySize size, const RowSink& done) {
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
            AccuracyRow row;
            row.problem =
                path == DrivenPath::uniaxial_strain ? "driven_rankine" : "driven_von_mises";
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
            done(row);
          }
        }
}

void study_rupture(StudySize size, const RowSink& done) {
  // The middle of the bar has 0.8 of the strength; softening is that of the whole.
  const Real tau_c = 0.8 * 5, fracture_energy = 0.5;
  const Real stress = tau_c * std::exp(-tau_c / 100);  // force over rest section
  const auto sweep = [&](const SolverDesc& solver, bool mesh, Real finest) {
    for (Real dx : {0.4, 0.2, 0.1}) {
      if (dx < finest * 0.99) break;
      BarRun run;
      run.dx = dx;
      run.mesh_force = mesh;
      run.solver = solver;
      if (!mesh) run.particles_per_cell = 8;
      AccuracyRow row;
      row.problem = "torn_bar";
      row.solver = solver;
      row.force = mesh ? ForceKind::mesh : ForceKind::particle;
      row.cells = static_cast<int>(std::lround(8 / dx));
      row.dx = dx;
      row.particles_per_cell = run.particles_per_cell;
      Torn bar;
      repeat(row, budget_of(size), [&] {
        bar = tear_bar(run);
        return bar.cost;
      });
      if (row.cost.status == Status::ok) {
        row.dissipated = bar.dissipated / fracture_energy;
        row.peak = bar.peak_force / stress;
        row.error = row.drift_energy = std::abs(row.dissipated - 1);
      }
      done(row);
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
    for (bool mesh : {true, false}) sweep(solver, mesh, 0.2);
}

void study_impact(StudySize size, const std::filesystem::path& scenes, const RowSink& done) {
  if (size == StudySize::smallest) return;
  const auto sweep = [&](const SolverDesc& solver, std::initializer_list<int> cells) {
    for (int n : cells) {
      AccuracyRow row;
      row.problem = "taylor_bar";
      row.solver = solver;
      row.cells = n;
      row.dx = kTaylorRadius / n;
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
      done(row);
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
  if (full) sweep(method(Transfer::apic), {3, 4});
}

}  // namespace rend
