// Where along its edge a crack passes: places the middles of broken edges so that crack faces are
// smooth at rest.
#pragma once

#include "engine/fracture/crack_mesh.h"
#include "engine/fracture/rotation_field.h"

#include <span>
#include <vector>

namespace rend {

/// Where particles are while the crack still grows, and how they have turned.
struct CrackMotion {
  std::span<const Vec3> x;         ///< #P [m]
  const RotationField* rotations;  ///< known for the ends of the records
};

/// Places the middles of `records` at shares t in [0.05, 0.95] of their edges, given the rest of
/// the crack as it lies. iterations = 0: t = 1/2. Else first t = f_a / (f_a + f_b), f = 1 - 2
/// (share of the neighbours across the crack, weighted with exp(-|X|^2/h^2)), then iterations - 2
/// Gauss-Seidel passes that slide each middle along its edge towards the plane of its neighbours. A
/// middle never leaves the slab between its two particles, skin stays skin.
/// Across the crack are torn neighbours; with `motion`, which foretells where the crack will go on,
/// also those that move along with the other end of the edge, by the squares of what they miss.
void smooth_middles(CrackMesh& crack, std::span<const Index> records, int iterations,
                    const CrackMotion* motion = nullptr);

}  // namespace rend
