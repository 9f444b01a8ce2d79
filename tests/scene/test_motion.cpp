// Keyframed poses against finite differences, distances against brute force and their own gradient.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "engine/core/random.h"
#include "engine/scene/motion.h"

namespace rend {

namespace {

const std::vector<Keyframe> kMotion{{0.5, Vec3(1, 0, 0), Vec3(0, 0, 0)},
                                    {1.0, Vec3(2, 1, 0), Vec3(0, 0, 90)},
                                    {2.0, Vec3(2, 3, -1), Vec3(200, -50, 30)},
                                    {2.5, Vec3(2, 3, -1), Vec3(200, -50, 30)}};

Vec3 random_point(Random& random, Real size) {
  return {random.next(-size, size), random.next(-size, size), random.next(-size, size)};
}

/// Points on the surface of a box or cylinder of unit size in [-1/2, 1/2]^3, about `n` along each
/// edge.
std::vector<Vec3> unit_surface(bool round, int n) {
  std::vector<Vec3> points;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const Real a = i / Real(n) - 0.5, b = j / Real(n) - 0.5;
      const Real angle = 2 * std::numbers::pi * a, r = 0.5 * (b + 0.5);
      for (const Real side : {-0.5, 0.5}) {
        if (round) {
          points.emplace_back(r * std::cos(angle), side, r * std::sin(angle));
          points.emplace_back(0.5 * std::cos(angle), b, 0.5 * std::sin(angle));
        } else {
          points.insert(points.end(), {Vec3(side, a, b), Vec3(a, side, b), Vec3(a, b, side)});
        }
      }
    }
  return points;
}

}  // namespace

TEST_CASE("poses pass through the keyframes and rest outside them") {
  for (const Keyframe& k : kMotion) {
    const RigidPose pose = pose_at(kMotion, k.time);
    CHECK((pose.position - k.position).norm() < 1e-14);
    CHECK((pose.rotation - rotation_from_degrees(k.rotation)).norm() < 1e-14);
  }
  for (const Real t : {-1e9, 0.0, 0.499999}) {
    CHECK(pose_at(kMotion, t).position == kMotion.front().position);
    CHECK(pose_at(kMotion, t).velocity == Vec3::Zero());
    CHECK(pose_at(kMotion, t).angular_velocity == Vec3::Zero());
  }
  for (const Real t : {2.5, 3.0, 1e9}) {
    CHECK(pose_at(kMotion, t).position == kMotion.back().position);
    CHECK(pose_at(kMotion, t).velocity == Vec3::Zero());
  }
  CHECK(pose_at({{1, Vec3(1, 2, 3), Vec3::Zero()}}, 0).position == Vec3(1, 2, 3));
  CHECK(pose_at({}, 0).rotation == Mat3::Identity());
}

TEST_CASE("the velocity of a pose is the time derivative of its points") {
  Random random(1, 0);
  const Real h = 1e-5;
  for (Real t = 0.05; t < 3; t += 0.1) {
    CAPTURE(t);
    const Vec3 local = random_point(random, 1);
    const Vec3 before = pose_at(kMotion, t - h).to_world(local);
    const Vec3 after = pose_at(kMotion, t + h).to_world(local);
    const RigidPose pose = pose_at(kMotion, t);
    CHECK((pose.velocity_at(pose.to_world(local)) - (after - before) / (2 * h)).norm() < 1e-7);
    CHECK((pose.to_local(pose.to_world(local)) - local).norm() < 1e-14);
    CHECK((pose.rotation * pose.rotation.transpose() - Mat3::Identity()).norm() < 1e-14);
  }
}

TEST_CASE("angular velocity has no jump where its series takes over") {
  for (const Real degrees : {1e-9, 0.05, 0.0572, 0.0574, 0.06}) {
    const std::vector<Keyframe> motion{{0, Vec3::Zero(), Vec3(degrees, 0, 0)},
                                       {1, Vec3::Zero(), Vec3(degrees, 60, 0)}};
    const Real h = 1e-6;
    const Mat3 rate = (pose_at(motion, 2 * h).rotation - pose_at(motion, 0).rotation) / (2 * h);
    const Mat3 spin = rate * pose_at(motion, h).rotation.transpose();
    const Vec3 expected(spin(2, 1), spin(0, 2), spin(1, 0));
    CHECK((pose_at(motion, h).angular_velocity - expected).norm() < 1e-9);
  }
}

TEST_CASE("a rotation vector turns by its length about itself") {
  CHECK((rotation_from_degrees({0, 0, 90}) * Vec3::UnitX() - Vec3::UnitY()).norm() < 1e-15);
  CHECK((rotation_from_degrees({180, 0, 0}) * Vec3::UnitY() + Vec3::UnitY()).norm() < 1e-15);
  CHECK((rotation_from_degrees({0, 720, 0}) - Mat3::Identity()).norm() < 1e-14);
  CHECK(rotation_from_degrees(Vec3::Zero()) == Mat3::Identity());
  const Vec3 r(30, -40, 50);
  CHECK((rotation_from_degrees(r) * r - r).norm() < 1e-13);
}

TEST_CASE("distances are exact") {
  const BoxDesc box{Vec3(1, 2, 3)};
  CHECK(distance_to(box, Vec3(1.5, 0, 0)).value == 1);
  CHECK(distance_to(box, Vec3(0.4, 0, 0)).value == doctest::Approx(-0.1));
  CHECK(distance_to(box, Vec3(3.5, 5, 1)).value == 5);
  CHECK(distance_to(box, Vec3(0, 0, 0)).value == -0.5);
  CHECK(distance_to(SphereDesc{2}, Vec3(0, -3, 0)).value == 1);
  CHECK(distance_to(SphereDesc{2}, Vec3::Zero()).value == -2);
  CHECK(distance_to(PlaneDesc{Vec3(0, 2, 0)}, Vec3(5, 3, 5)).value == 3);
  const CylinderDesc cylinder{1, 2};
  CHECK(distance_to(cylinder, Vec3(3, 0, 0)).value == 2);
  CHECK(distance_to(cylinder, Vec3(0, 0, 4)).value == 3);
  CHECK(distance_to(cylinder, Vec3(0, -4, 0)).value == 3);
  CHECK(distance_to(cylinder, Vec3(4, 5, 0)).value == 5);
  CHECK(distance_to(cylinder, Vec3(0, 0.9, 0)).value == doctest::Approx(-0.1));
}

TEST_CASE("distances agree with the nearest of many points on the surface") {
  Random random(2, 0);
  const Vec3 size(0.6, 1, 0.8), round_size(0.8, 1.2, 0.8);
  const auto check = [&](const ColliderShape& shape, bool round, const Vec3& extent) {
    const std::vector<Vec3> surface = unit_surface(round, 200);
    for (int i = 0; i < 40; ++i) {
      const Vec3 p = random_point(random, i % 2 ? 0.4 : 1);
      Real nearest = 1e9;
      for (const Vec3& unit : surface)
        nearest = std::min(nearest, (unit.cwiseProduct(extent) - p).norm());
      const Vec3 half = extent / 2;
      const bool inside = round ? std::hypot(p.x(), p.z()) < half.x() && std::abs(p.y()) < half.y()
                                : (p.cwiseAbs().array() < half.array()).all();
      CHECK(std::abs(distance_to(shape, p).value - (inside ? -nearest : nearest)) < 0.005);
    }
  };
  check(BoxDesc{size}, false, size);
  check(CylinderDesc{0.4, 1.2}, true, round_size);
}

TEST_CASE("the normal is the gradient of the distance, of length 1 everywhere") {
  Random random(3, 0);
  const ColliderShape shapes[] = {PlaneDesc{Vec3(1, 2, -2)}, BoxDesc{Vec3(1, 2, 3)},
                                  SphereDesc{0.7}, CylinderDesc{0.8, 1.5}};
  const Real h = 1e-6;
  for (const ColliderShape& shape : shapes) {
    CAPTURE(shape.index());
    CHECK(std::isfinite(distance_to(shape, Vec3::Zero()).value));
    CHECK(distance_to(shape, Vec3::Zero()).normal.norm() == doctest::Approx(1));
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = random_point(random, 2);
      const Distance distance = distance_to(shape, p);
      CHECK(distance.normal.norm() == doctest::Approx(1).epsilon(1e-14));
      Vec3 gradient;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = Vec3::Unit(axis) * h;
        gradient[axis] =
            (distance_to(shape, p + step).value - distance_to(shape, p - step).value) / (2 * h);
      }
      CHECK((gradient - distance.normal).norm() < 1e-5);
    }
  }
}

}  // namespace rend
