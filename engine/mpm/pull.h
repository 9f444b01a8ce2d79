// The pull tool: a force on the matter around a point, constant or from a spring that holds the
// matter.
#pragma once

#include "engine/core/types.h"

namespace rend {

/// Shared out by mass and falloff(|x - at|). Without stiffness it is `force` at a fixed point. With
/// stiffness it is a critically damped spring from the grip `at`, which goes with the matter that
/// it holds, to `target`; `force` is then what the spring did in the last step.
struct PullForce {
  Vec3 at = Vec3::Zero();      ///< [m]
  Vec3 force = Vec3::Zero();   ///< total force [N]
  Real radius = 0;             ///< [m]; 0 is off
  Vec3 target = Vec3::Zero();  ///< [m]
  Real stiffness = 0;          ///< [N/m]; 0 is a constant force
  Real strongest = 0;          ///< limit on the force of the spring [N]

  bool is_spring() const { return radius > 0 && stiffness > 0; }
};

/// Matter under the falloff of a pull; sums over nodes.
struct PulledMatter {
  Real mass = 0;                 ///< sum of m falloff [kg]
  Vec3 momentum = Vec3::Zero();  ///< sum of m falloff v [kg m/s]

  PulledMatter& operator+=(const PulledMatter& other) {
    mass += other.mass;
    momentum += other.momentum;
    return *this;
  }
};

/// Lets a spring act on `matter` over a step dt [s]. With m and v of the matter, c = 2 sqrt(k m)
/// and an implicit step,
///   v' = (m v + dt k (target - at)) / (m + dt c + dt^2 k),  force = m (v' - v) / dt,
/// cut to `strongest`; no stiffness and no mass makes it unstable. Before that the grip moves on by
/// dt v. A constant force stays as it is; a spring that holds nothing does nothing.
void advance_spring(PullForce& pull, const PulledMatter& matter, Real dt);

}  // namespace rend
