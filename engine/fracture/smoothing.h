// Where along its edge a crack passes: places the middles of broken edges so that crack faces are
// smooth at rest.
#pragma once

#include "engine/fracture/crack_mesh.h"

#include <span>
#include <vector>

namespace rend {

/// Places the middles of `records` at shares t in [0.05, 0.95] of their edges, given the rest of
/// the crack as it lies. iterations = 0: t = 1/2. Else first t = f_a / (f_a + f_b), f = 1 - 2
/// (broken share of the neighbours, weighted with exp(-|X|^2/h^2)), then iterations - 2
/// Gauss-Seidel passes that slide each middle along its edge towards the plane of its neighbours. A
/// middle never leaves the slab between its two particles, skin stays skin.
void smooth_middles(CrackMesh& crack, std::span<const Index> records, int iterations);

}  // namespace rend
