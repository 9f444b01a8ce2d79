// One run of the work-precision study: which method on which problem, what it took, how far off it
// was.
#pragma once

#include "bench/problems/trial.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace rend {

inline constexpr Real kNotMeasured = std::numeric_limits<Real>::quiet_NaN();

struct AccuracyRow {
  std::string problem;
  SolverDesc solver;
  ForceKind force = ForceKind::particle;
  SofteningRule rule = SofteningRule::implicit_rule;
  int cells = 0;  ///< along the length that the problem is resolved by
  Real dx = 0;    ///< [m]
  Real particles_per_cell = 8;
  Real courant = kNotMeasured;  ///< dt c_p / dx; not measured: by cfl

  RunCost cost;  ///< CPU and wall seconds are medians of the repeats
  int repeats = 1;
  Real cpu_seconds_min = 0, wall_seconds_min = 0;
  Real instructions = kNotMeasured;  ///< of the last repeat, set-up included
  Real peak_memory = kNotMeasured;   ///< of the process [bytes]

  Real error = kNotMeasured;  ///< the one that plots show
  Real error_u = kNotMeasured, error_v = kNotMeasured, error_tau = kNotMeasured;
  Real rounding = kNotMeasured;      ///< displacement against double, over the amplitude
  Real drift_energy = kNotMeasured;  ///< relative
  Real drift_momentum = kNotMeasured, drift_spin = kNotMeasured;
  Real y_max = kNotMeasured;                            ///< largest y over tau_c
  Real dissipation_min = kNotMeasured;                  ///< smallest of a step, over the whole
  Real dissipated = kNotMeasured, peak = kNotMeasured;  ///< over the exact values
  Real length = kNotMeasured, radius = kNotMeasured;    ///< of a struck bar over the exact ones

  Real ns_per_particle_step() const { return 1e9 * cost.cpu_seconds / cost.particle_steps(); }
  /// Same curve in a plot: everything but the resolution.
  bool same_method(const AccuracyRow& other) const;
};

std::string accuracy_csv(const std::vector<AccuracyRow>& rows);

/// Runs `run` until `budget` CPU seconds or five repeats are used up, at least once, and keeps the
/// medians.
void repeat(AccuracyRow& row, Real budget, const std::function<RunCost()>& run);

/// CPU seconds that the curve of `method` needs for `error`, between its points on log-log axes;
/// not measured outside of them.
Real cost_at_error(const std::vector<AccuracyRow>& rows, const AccuracyRow& method, Real error);

}  // namespace rend
