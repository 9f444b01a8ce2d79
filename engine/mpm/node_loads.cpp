// Pull tool and contact, node by node.
#include "engine/mpm/node_loads.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace rend {

NodeLoads::NodeLoads(const std::vector<ColliderDesc>& colliders, const PullForce& pull, Real time,
                     const NodeRule& rule)
    : colliders_(pose_colliders(colliders, time)), pull_(pull), time_(time), rule_(rule) {}

Real NodeLoads::collider_speed() const {
  Real fastest = 0;
  for (const PosedCollider& c : colliders_) fastest = std::max(fastest, fastest_point(c));
  return fastest;
}

Real NodeLoads::falloff(const Vec3& x) const {
  const Real s = 1 - (x - pull_.at).squaredNorm() / (pull_.radius * pull_.radius);
  return s > 0 ? s * s : 0;
}

PulledMatter NodeLoads::pulled(const Vec3& x, Real mass, const Vec3& v) const {
  const Real share = falloff(x);
  return {mass * share, mass * share * share, mass * share * v};
}

Real NodeLoads::set_pulled(const PulledMatter& matter, Real dt, PullForce& pull) {
  pulled_mass_ = matter.mass;
  advance_spring(pull, matter, dt);
  pull_.force = pull.force;
  return work_of_pull(pull, matter, dt);
}

NodeLoads::Near NodeLoads::near(const Vec3& centre, Real radius) const {
  Near out;
  for (const PosedCollider& c : colliders_)
    if (distance_to(c.desc->shape, c.pose.to_local(centre)).value <= radius)
      out.colliders.push_back(&c);
  out.pull = pulled_mass_ > 0 && (centre - pull_.at).norm() <= pull_.radius + radius;
  out.rule = static_cast<bool>(rule_);
  return out;
}

bool NodeLoads::meets(const Near& near, const Vec3& x) const {
  return std::any_of(near.colliders.begin(), near.colliders.end(), [&](const PosedCollider* c) {
    return distance_to(c->desc->shape, c->pose.to_local(x)).value <= 0;
  });
}

Vec3 NodeLoads::apply(const Near& near, const Vec3& x, Real mass, Real dt, Vec3 v,
                      NodeWork& work) const {
  if (near.pull) v += dt / pulled_mass_ * falloff(x) * pull_.force;
  for (const PosedCollider* c : near.colliders) {
    const Distance distance = distance_to(c->desc->shape, c->pose.to_local(x));
    if (distance.value > 0) continue;
    const Vec3 wall = c->pose.velocity_at(x);
    const Vec3 after = wall + relative_velocity_after_contact(*c->desc, v - wall,
                                                              c->pose.rotation * distance.normal);
    const Vec3 impulse = mass * (after - v);
    work.external += impulse.dot(wall);
    // With the velocity after the step, as for the elastic energy: matter that is held loses none.
    work.friction -= impulse.dot(after - wall);
    v = after;
  }
  if (near.rule) {
    const Vec3 after = rule_(x, time_, dt, v);
    work.external += 0.5 * mass * (after - v).dot(after + v);
    v = after;
  }
  return v;
}

}  // namespace rend
