// Boundary conditions of rigid colliders.
#include "engine/mpm/collider_contact.h"

#include <algorithm>

namespace rend {

namespace {

struct Reach {
  Real operator()(const PlaneDesc&) const { return 0; }
  Real operator()(const BoxDesc& box) const { return 0.5 * box.size.norm(); }
  Real operator()(const SphereDesc& sphere) const { return sphere.radius; }
  Real operator()(const CylinderDesc& c) const { return std::hypot(c.radius, 0.5 * c.height); }
};

}  // namespace

std::vector<PosedCollider> pose_colliders(const std::vector<ColliderDesc>& colliders, Real time) {
  std::vector<PosedCollider> posed;
  for (const ColliderDesc& collider : colliders)
    if (collider.release_time < 0 || time < collider.release_time)
      posed.push_back(
          {&collider, pose_at(collider.motion, time), std::visit(Reach{}, collider.shape)});
  return posed;
}

Real fastest_point(const PosedCollider& collider) {
  return collider.pose.velocity.norm() + collider.reach * collider.pose.angular_velocity.norm();
}

Vec3 relative_velocity_after_contact(const ColliderDesc& collider, const Vec3& relative,
                                     const Vec3& normal) {
  if (collider.contact == Contact::stick) return Vec3::Zero();
  const Real approach = relative.dot(normal);
  if (collider.contact == Contact::separate && approach >= 0) return relative;
  const Vec3 tangential = relative - approach * normal;
  const Real speed = tangential.norm();
  const Real slowed = std::max(speed - collider.friction * std::abs(approach), 0.0);
  return speed > 0 ? Vec3(slowed / speed * tangential) : Vec3::Zero();
}

}  // namespace rend
