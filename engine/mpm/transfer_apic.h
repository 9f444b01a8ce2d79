// APIC: a particle carries an affine velocity field (Jiang et al. 2015).
#pragma once

#include "engine/mpm/block_grid.h"
#include "engine/mpm/particles.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// v_p = sum w v_i, C_p = B_p D^-1 with B_p = sum w v_i (x_i - x_p)^T of the *updated* grid
/// velocity; conserves linear and angular momentum and reproduces affine fields.
struct ApicTransfer {
  static constexpr Transfer kType = Transfer::apic;
  static constexpr bool kAffine = true;

  static CarriedModes carries(const SolverDesc&) { return {true, false}; }

  static Vec3 carried(const Particles& particles, Index p, const Vec3& r) {
    const auto i = static_cast<std::size_t>(p);
    return particles.v[i] + particles.C[i] * r;
  }

  struct Sums {
    void add(Real, const NodeVelocity&, const Vec3&) {}
  };

  static void receive(const Sums&, const Vec3& pic, const Mat3& B, Real inertia, const SolverDesc&,
                      Particles& particles, Index p) {
    const auto i = static_cast<std::size_t>(p);
    particles.v[i] = pic;
    particles.C[i] = B / inertia;
  }
};

}  // namespace rend
