// RPIC: a particle carries a rigid velocity field, blended with APIC (Jiang et al. 2015).
#pragma once

#include "engine/mpm/block_grid.h"
#include "engine/mpm/particles.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// As APIC with C <- (r + 1)/2 C + (r - 1)/2 C^T, r = rpic_blend: 1 is APIC, 0 keeps the spin
/// alone. The symmetric part carries no angular momentum, so both momenta are conserved for any r.
struct RpicTransfer {
  static constexpr Transfer kType = Transfer::rpic;
  static constexpr bool kAffine = true;

  static CarriedModes carries(const SolverDesc&) { return {true, false}; }

  static Vec3 carried(const Particles& particles, Index p, const Vec3& r) {
    const auto i = static_cast<std::size_t>(p);
    return particles.v[i] + particles.C[i] * r;
  }

  struct Sums {
    void add(Real, const NodeVelocity&, const Vec3&) {}
  };

  static void receive(const Sums&, const Vec3& pic, const Mat3& B, Real inertia,
                      const SolverDesc& solver, Particles& particles, Index p) {
    const auto i = static_cast<std::size_t>(p);
    const Real keep = 0.5 * (solver.rpic_blend + 1), swap = 0.5 * (solver.rpic_blend - 1);
    particles.v[i] = pic;
    particles.C[i] = (keep * B + swap * B.transpose()) / inertia;
  }
};

}  // namespace rend
