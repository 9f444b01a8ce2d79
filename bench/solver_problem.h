// The problem that every solver benchmark runs.
#pragma once

#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

namespace rend {

inline constexpr Real kBenchTimeStep = 1.7e-3;  ///< [s]; about 0.2 dx / c

/// dx = 1, density 1, E = 1e4, a fixed step, no gravity, one material of this yield surface.
SceneDesc bench_scene(const char* surface);

/// A box of cells^3 cells with 8 particles each that stretches, shears and waves: most of it yields
/// within ten steps. Numbers that float holds exactly, so that all solvers start alike, in random
/// order.
Model bench_model(int cells);

}  // namespace rend
