// Scenes in float, for the tests of the tile solver.
#pragma once

#include "engine/mpm/tile_kernel.h"
#include "tests/mpm/lattice_model.h"

#include <cmath>
#include <cstring>

namespace rend::test {

inline SceneDesc float_scene() {
  SceneDesc scene = plain_scene();
  scene.solver.precision = Precision::float32;
  return scene;
}

inline ColliderDesc floor_collider(Contact contact) {
  ColliderDesc floor;
  floor.shape = PlaneDesc{Vec3(0, 1, 0)};
  floor.contact = contact;
  floor.friction = 0.3;
  floor.motion.push_back({});
  return floor;
}

/// nullptr when this CPU does not have them.
inline const TileKernels* kernels_named(const char* name) {
  for (const TileKernels* kernels : all_tile_kernels())
    if (std::strcmp(kernels->name, name) == 0) return kernels;
  return nullptr;
}

inline bool close(Real a, Real b, Real relative) {
  return std::abs(a - b) <= relative * std::abs(b);
}

}  // namespace rend::test
