// XPIC(m): PIC without its damping of what the grid can resolve (Hammerquist and Nairn 2017).
#pragma once

#include "engine/mpm/block_grid.h"
#include "engine/mpm/particles.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// v_p = sum w (v_i + sum_{k=2..m} d_k), see add_xpic_series; m = 1 is PIC, m -> infinity is FLIP
/// without the velocities that the grid cannot see. Conserves linear momentum.
struct XpicTransfer {
  static constexpr Transfer kType = Transfer::xpic;
  static constexpr bool kAffine = false;

  static CarriedModes carries(const SolverDesc&) { return {}; }

  static Vec3 carried(const Particles& particles, Index p, const Vec3&) {
    return particles.v[static_cast<std::size_t>(p)];
  }

  struct Sums {
    Vec3 series = Vec3::Zero();
    void add(Real w, const NodeVelocity& node, const Vec3&) { series += w * node.change; }
  };

  static void receive(const Sums& sums, const Vec3& pic, const Mat3&, Real, const SolverDesc&,
                      Particles& particles, Index p) {
    particles.v[static_cast<std::size_t>(p)] = pic + sums.series;
  }
};

}  // namespace rend
