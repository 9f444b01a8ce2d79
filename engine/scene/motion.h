// Keyframed rigid motion of a collider.
#pragma once

#include "engine/scene/scene_desc.h"

#include <Eigen/Geometry>

namespace rend {

/// Pose and velocity of a rigid body at one time.
struct RigidPose {
  Vec3 position = Vec3::Zero();  ///< [m]
  Mat3 rotation = Mat3::Identity();
  Vec3 velocity = Vec3::Zero();          ///< of the origin [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s]

  Vec3 to_world(const Vec3& local) const { return position + rotation * local; }
  Vec3 to_local(const Vec3& world) const { return rotation.transpose() * (world - position); }
  /// Velocity of the material point that is at `world` now [m/s].
  Vec3 velocity_at(const Vec3& world) const {
    return velocity + angular_velocity.cross(world - position);
  }
};

/// Pose of a collider at a time [s]; linear between keyframes (rotation vectors too), constant
/// outside; at a keyframe the velocity is that of the segment after it.
RigidPose pose_at(const std::vector<Keyframe>& motion, Real time);

/// Signed distance [m] from a point in the collider's own frame, negative inside, and its outward
/// gradient.
struct Distance {
  Real value;
  Vec3 normal;
};
Distance distance_to(const ColliderShape& shape, const Vec3& local);

/// Rotation matrix of a rotation vector in degrees.
Mat3 rotation_from_degrees(const Vec3& rotation_vector);

}  // namespace rend
