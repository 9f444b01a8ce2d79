// What reaches grid nodes from outside: the pull tool and colliders. Shared by both solvers.
#pragma once

#include "engine/mpm/collider_contact.h"
#include "engine/mpm/energy_balance.h"
#include "engine/mpm/solver.h"

#include <vector>

namespace rend {

/// Loads of one step on nodes in world units.
class NodeLoads {
 public:
  /// Colliders are posed at `time`, the end of the step [s].
  NodeLoads(const std::vector<ColliderDesc>& colliders, const PullForce& pull, Real time,
            const NodeRule& rule = {});

  bool none() const { return colliders_.empty() && pull_.radius <= 0 && !rule_; }
  bool pulls() const { return pull_.radius > 0; }
  /// Fastest point of a collider [m/s].
  Real collider_speed() const;

  /// Share (0..1) of the pull at a point, (1 - r^2/R^2)^2 inside the radius.
  Real falloff(const Vec3& x) const;
  /// What the pull acts on, to be summed over nodes of mass m [kg] and velocity v.
  PulledMatter pulled(const Vec3& x, Real mass, const Vec3& v) const;
  /// Lets the pull act on this matter in a step dt [s]; `pull` keeps how it goes on. Its work [J].
  Real set_pulled(const PulledMatter& matter, Real dt, PullForce& pull);
  /// Marks the pull as holding something, where only its place matters.
  void assume_pulled() { pulled_mass_ = 1; }

  /// Colliders that nodes within `radius` of `centre` can meet.
  struct Near {
    std::vector<const PosedCollider*> colliders;
    bool pull = false;
    bool rule = false;
    bool none() const { return colliders.empty() && !pull && !rule; }
  };
  Near near(const Vec3& centre, Real radius) const;

  /// Whether a point is inside one of these colliders.
  bool meets(const Near& near, const Vec3& x) const;

  /// Velocity of a node of mass m [kg] at x after pull, contact and rule; adds the work [J] of the
  /// last two to `work`.
  Vec3 apply(const Near& near, const Vec3& x, Real mass, Real dt, Vec3 v, NodeWork& work) const;

 private:
  std::vector<PosedCollider> colliders_;
  PullForce pull_;
  Real time_;
  NodeRule rule_;
  Real pulled_mass_ = 0;
};

}  // namespace rend
