// Methods, bodies and runs of the verification tests, and how long these may take.
#pragma once

#include "bench/problems/lattice_model.h"
#include "bench/problems/method.h"
#include "bench/problems/trial.h"
#include "engine/core/small_matrix.h"
#include "engine/mpm/kernel.h"
#include "engine/mpm/reference_solver.h"
#include "engine/mpm/tile_solver.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace rend {

/// Whether the long versions of the studies are asked for.
inline bool full_study() { return std::getenv("REND_FULL") != nullptr; }

}  // namespace rend
