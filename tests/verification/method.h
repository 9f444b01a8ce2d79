// Methods, bodies and runs of the verification tests, and how long these may take.
#pragma once

#include "bench/problems/lattice_model.h"
#include "bench/problems/method.h"
#include "bench/problems/trial.h"
#include "engine/core/small_matrix.h"
#include "engine/mpm/kernel.h"
#include "engine/mpm/reference_solver.h"
#include "engine/mpm/tile_solver.h"
#include "tests/effort.h"

#include <fmt/format.h>

#include <cmath>

namespace rend {

/// Whether the long versions of the studies are asked for.
inline bool full_study() { return test::full_effort(); }

/// Whether a sanitizer runs: convergence studies then take one kernel and one form of the force,
/// since all go through the same code.
inline bool brief_study() { return test::by_effort(true, false, false); }
inline bool left_out(const SolverDesc& solver) {
  return brief_study() &&
         (solver.kernel == Kernel::cubic || solver.force_form == ForceForm::gradient);
}

}  // namespace rend
