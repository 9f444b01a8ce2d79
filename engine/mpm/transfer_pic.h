// PIC: a particle takes the grid velocity at its place (Harlow 1964).
#pragma once

#include "engine/mpm/block_grid.h"
#include "engine/mpm/particles.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// v_p = sum w v_i. Stable and strongly damped; loses angular momentum.
struct PicTransfer {
  static constexpr Transfer kType = Transfer::pic;
  static constexpr bool kAffine = false;

  /// What a particle holds beyond its velocity.
  static CarriedModes carries(const SolverDesc&) { return {}; }

  /// Velocity that particle p shows to a node at offset r = x_i - x_p.
  static Vec3 carried(const Particles& particles, Index p, const Vec3&) {
    return particles.v[static_cast<std::size_t>(p)];
  }

  /// Sums over the nodes of one particle beyond those of GridSample.
  struct Sums {
    void add(Real, const NodeVelocity&, const Vec3&) {}
  };

  /// New velocity of particle p: `pic` = sum w v_i, B = sum w v_i r^T, inertia = D.
  static void receive(const Sums&, const Vec3& pic, const Mat3&, Real, const SolverDesc&,
                      Particles& particles, Index p) {
    particles.v[static_cast<std::size_t>(p)] = pic;
  }
};

}  // namespace rend
