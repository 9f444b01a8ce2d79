// FLIP: a particle takes the change of the grid velocity, blended with PIC (Brackbill and Ruppel
// 1986).
#pragma once

#include "engine/mpm/block_grid.h"
#include "engine/mpm/particles.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// v_p <- a (v_p + sum w (v_i - v_i^n)) + (1 - a) sum w v_i with a = flip_ratio; a = 0 is PIC to
/// the bit.
struct FlipTransfer {
  static constexpr Transfer kType = Transfer::flip;
  static constexpr bool kAffine = false;

  static CarriedModes carries(const SolverDesc&) { return {}; }

  static Vec3 carried(const Particles& particles, Index p, const Vec3&) {
    return particles.v[static_cast<std::size_t>(p)];
  }

  struct Sums {
    Vec3 change = Vec3::Zero();
    void add(Real w, const NodeVelocity& node, const Vec3&) { change += w * node.change; }
  };

  static void receive(const Sums& sums, const Vec3& pic, const Mat3&, Real,
                      const SolverDesc& solver, Particles& particles, Index p) {
    Vec3& v = particles.v[static_cast<std::size_t>(p)];
    v = solver.flip_ratio == 0
            ? pic
            : Vec3(solver.flip_ratio * (v + sums.change) + (1 - solver.flip_ratio) * pic);
  }
};

}  // namespace rend
