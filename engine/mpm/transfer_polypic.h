// PolyPIC: a particle carries a polynomial velocity field (Fu et al. 2017), up to the multilinear
// modes.
#pragma once

#include "engine/mpm/block_grid.h"
#include "engine/mpm/particles.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// Modes s of r = x_i - x_p, orthogonal under the weights of a tensor-product kernel: 1 | x, y, z |
/// xy, yz, zx, xyz, with coefficients sum w s v_i / sum w s^2 and sum w s^2 = D^degree. With 1 mode
/// it is PIC, with 4 APIC; all 8 reproduce multilinear fields. The last four have no momentum and
/// no angular momentum.
struct PolyPicTransfer {
  static constexpr Transfer kType = Transfer::polypic;
  static constexpr bool kAffine = true;

  static CarriedModes carries(const SolverDesc& solver) {
    return {solver.polypic_modes >= 4, solver.polypic_modes >= 8};
  }

  /// Values of xy, yz, zx, xyz.
  static Eigen::Vector4d multilinear(const Vec3& r) {
    return {r[0] * r[1], r[1] * r[2], r[2] * r[0], r[0] * r[1] * r[2]};
  }

  static Vec3 carried(const Particles& particles, Index p, const Vec3& r) {
    const auto i = static_cast<std::size_t>(p);
    Vec3 v = particles.v[i];
    if (!particles.C.empty()) v += particles.C[i] * r;
    if (!particles.modes.empty()) v += particles.modes[i] * multilinear(r);
    return v;
  }

  struct Sums {
    VelocityModes modes = VelocityModes::Zero();
    void add(Real w, const NodeVelocity& node, const Vec3& r) {
      modes += (w * node.v) * multilinear(r).transpose();
    }
  };

  static void receive(const Sums& sums, const Vec3& pic, const Mat3& B, Real inertia,
                      const SolverDesc&, Particles& particles, Index p) {
    const auto i = static_cast<std::size_t>(p);
    particles.v[i] = pic;
    if (!particles.C.empty()) particles.C[i] = B / inertia;
    if (particles.modes.empty()) return;
    particles.modes[i] = sums.modes / (inertia * inertia);
    particles.modes[i].col(3) /= inertia;
  }
};

}  // namespace rend
