// Scenes in float, for the tests of the tile solver.
#pragma once

#include "engine/core/parallel.h"
#include "engine/mpm/tile_kernel.h"
#include "tests/mpm/lattice_model.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
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

/// Checks that hash_of(kernels, threads) is the same for AVX-512 and AVX2, as far as this CPU has
/// them, and one to four threads.
template <class F>
void check_same_bits(F&& hash_of) {
  std::uint64_t hash = 0;
  for (const TileKernels* kernels : all_tile_kernels()) {
    if (std::strcmp(kernels->name, "sse4") == 0) continue;
    for (int threads : {1, 2, 3, 4}) {
      CAPTURE(kernels->name);
      CAPTURE(threads);
      set_thread_count(threads);
      const std::uint64_t now = hash_of(kernels, threads);
      if (hash == 0) hash = now;
      CHECK(now == hash);
    }
  }
  set_thread_count(0);
}

inline bool close(Real a, Real b, Real relative) {
  return std::abs(a - b) <= relative * std::abs(b);
}

}  // namespace rend::test
