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
  /// Mean velocity of the matter under it, weighted as the force is, after the last step [m/s].
  Vec3 velocity = Vec3::Zero();
  Real acted = 0;  ///< for how long it has held matter [s]; 0: `velocity` is not known yet

  bool is_spring() const { return radius > 0 && stiffness > 0; }

  /// Calls visit(value) for everything that a state file keeps of a pull.
  template <class Pull, class Visit>
  static void visit_state(Pull& pull, Visit&& visit) {
    visit(pull.at), visit(pull.force), visit(pull.radius), visit(pull.target);
    visit(pull.stiffness), visit(pull.strongest), visit(pull.velocity), visit(pull.acted);
  }
};

/// Matter under the falloff of a pull; sums over nodes.
struct PulledMatter {
  Real mass = 0;                 ///< sum of m falloff [kg]
  Real mass2 = 0;                ///< sum of m falloff^2 [kg]
  Vec3 momentum = Vec3::Zero();  ///< sum of m falloff v [kg m/s]

  PulledMatter& operator+=(const PulledMatter& other) {
    mass += other.mass;
    mass2 += other.mass2;
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

/// Work of the force in a step dt [s] on this matter, F dt (v_before + v_after) / 2 [J], where
/// v_before is what `pull` keeps of the step before: in `matter` the stress, which works against
/// the pull, has acted already.
Real work_of_pull(PullForce& pull, const PulledMatter& matter, Real dt);

}  // namespace rend
