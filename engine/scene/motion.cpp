// Poses between keyframes, and signed distances of collider shapes.
#include "engine/scene/motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rend {

namespace {

constexpr Real kDegree = std::numbers::pi / 180;

Mat3 skew(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Mat3 rotation_of(const Vec3& r) {
  const Real angle = r.norm();
  return angle == 0 ? Mat3::Identity() : Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
}

/// Angular velocity of exp([r]x) when r changes at `rate`: the left Jacobian of SO(3) times the
/// rate.
Vec3 angular_velocity_of(const Vec3& r, const Vec3& rate) {
  const Real angle2 = r.squaredNorm();
  Real a = 0.5 - angle2 / 24, b = 1. / 6 - angle2 / 120;
  if (angle2 > 1e-6) {
    const Real angle = std::sqrt(angle2);
    a = (1 - std::cos(angle)) / angle2;
    b = (angle - std::sin(angle)) / (angle2 * angle);
  }
  const Mat3 k = skew(r);
  return rate + a * (k * rate) + b * (k * (k * rate));
}

/// Distance to the product of an interval-like part and another one, from the signed excess over
/// each of them.
Distance combine(Real p, const Vec3& p_normal, Real q, const Vec3& q_normal) {
  if (p > 0 && q > 0) {
    const Real value = std::hypot(p, q);
    return {value, (p * p_normal + q * q_normal) / value};
  }
  return p > q ? Distance{p, p_normal} : Distance{q, q_normal};
}

Distance shape_distance(const PlaneDesc& plane, const Vec3& x) {
  const Vec3 normal = plane.normal.normalized();
  return {normal.dot(x), normal};
}

Distance shape_distance(const SphereDesc& sphere, const Vec3& x) {
  const Real r = x.norm();
  return {r - sphere.radius, r > 0 ? Vec3(x / r) : Vec3::UnitY()};
}

Distance shape_distance(const BoxDesc& box, const Vec3& x) {
  const Vec3 excess = x.cwiseAbs() - box.size / 2;
  const Vec3 sign = x.unaryExpr([](Real v) { return v < 0 ? -1. : 1.; });
  const Vec3 outside = excess.cwiseMax(0);
  const Real value = outside.norm();
  if (value > 0) return {value, outside.cwiseProduct(sign) / value};
  int axis = 0;
  const Real inside = excess.maxCoeff(&axis);
  return {inside, Vec3::Unit(axis) * sign[axis]};
}

Distance shape_distance(const CylinderDesc& cylinder, const Vec3& x) {
  const Real r = std::hypot(x.x(), x.z());
  const Vec3 radial = r > 0 ? Vec3(x.x() / r, 0, x.z() / r) : Vec3::UnitX();
  return combine(r - cylinder.radius, radial, std::abs(x.y()) - cylinder.height / 2,
                 x.y() < 0 ? Vec3(-Vec3::UnitY()) : Vec3::UnitY());
}

}  // namespace

Mat3 rotation_from_degrees(const Vec3& rotation_vector) {
  return rotation_of(rotation_vector * kDegree);
}

RigidPose pose_at(const std::vector<Keyframe>& motion, Real time) {
  RigidPose pose;
  if (motion.empty()) return pose;
  const auto next = std::upper_bound(motion.begin(), motion.end(), time,
                                     [](Real t, const Keyframe& k) { return t < k.time; });
  if (next == motion.begin() || next == motion.end()) {
    const Keyframe& held = next == motion.begin() ? motion.front() : motion.back();
    pose.position = held.position;
    pose.rotation = rotation_from_degrees(held.rotation);
    return pose;
  }
  const Keyframe &from = *(next - 1), &to = *next;
  const Real length = to.time - from.time;
  const Real share = (time - from.time) / length;
  const Vec3 r = (from.rotation + share * (to.rotation - from.rotation)) * kDegree;
  const Vec3 rate = (to.rotation - from.rotation) * (kDegree / length);
  pose.position = from.position + share * (to.position - from.position);
  pose.rotation = rotation_of(r);
  pose.velocity = (to.position - from.position) / length;
  pose.angular_velocity = angular_velocity_of(r, rate);
  return pose;
}

Distance distance_to(const ColliderShape& shape, const Vec3& local) {
  return std::visit([&](const auto& s) { return shape_distance(s, local); }, shape);
}

}  // namespace rend
