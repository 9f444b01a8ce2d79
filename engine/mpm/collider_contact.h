// Contact of grid nodes with rigid colliders.
#pragma once

#include "engine/scene/motion.h"
#include "engine/scene/scene_desc.h"

#include <vector>

namespace rend {

/// A collider at one instant.
struct PosedCollider {
  const ColliderDesc* desc;
  RigidPose pose;
  Real reach;  ///< largest distance of a point of a finite shape from its origin [m]; 0 for a plane
};

/// Colliders that exist at `time` [s], in the order of the scene.
std::vector<PosedCollider> pose_colliders(const std::vector<ColliderDesc>& colliders, Real time);

/// Upper bound of the speed of a collider's surface [m/s].
Real fastest_point(const PosedCollider& collider);

/// Relative velocity of matter after contact: 0 (stick); the tangential part (slip, and separate
/// when approaching along the outward normal), reduced by Coulomb friction |dv_t| <= friction
/// |dv_n|.
Vec3 relative_velocity_after_contact(const ColliderDesc& collider, const Vec3& relative,
                                     const Vec3& normal);

}  // namespace rend
