// A copper bar that hits a rigid wall (Taylor impact), scenes/taylor_bar.json.
#pragma once

#include "bench/problems/trial.h"

#include <filesystem>

namespace rend {

inline constexpr Real kTaylorRadius = 3.2e-3, kTaylorHeight = 32.4e-3;  ///< [m]

/// Kamoulakos (1990) and later codes: 21.4 to 21.5 mm and 7.0 to 7.2 mm.
inline constexpr Real kTaylorLength = 21.45e-3, kTaylorFoot = 7.1e-3;

struct TaylorShape {
  Real length = 0, foot = 0;  ///< final length and radius at the wall [m]
  Real kinetic = 0;           ///< energy left at the end [J]
  Real dissipated = 0;        ///< over the energy at the start
  RunCost cost;
};

/// `scenes`: the folder of taylor_bar.json.
TaylorShape strike_wall(const std::filesystem::path& scenes, Real dx, const SolverDesc& solver);

}  // namespace rend
