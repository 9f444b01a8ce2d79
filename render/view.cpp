// Camera maths in single precision.
#include "render/view.h"

#include "engine/core/error.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace rend {

PerspectiveView make_view(const Camera& camera, int width, int height, const Bounds3f& bounds) {
  if (!camera.eye.allFinite() || !camera.target.allFinite() || !camera.up.allFinite())
    throw Error("camera", "eye, target and up must be finite numbers");
  if (!(camera.fov >= 1 && camera.fov <= 150))
    throw Error("camera/fov", fmt::format("{} degrees; allowed are 1 to 150", camera.fov));
  const Vec3 ahead = camera.target - camera.eye;
  const Real distance = ahead.norm();
  if (!(distance > 1e-9)) throw Error("camera", "eye and target are the same point");

  PerspectiveView view;
  view.width = width;
  view.height = height;
  const Vec3 forward = ahead / distance;
  Vec3 side = forward.cross(camera.up);
  // Looking straight along `up`: any other direction serves as well as the next.
  if (side.norm() < 1e-6 * std::max(camera.up.norm(), 1e-12))
    side = forward.cross(std::abs(forward.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX());
  side.normalize();
  view.eye = camera.eye.cast<float>();
  view.forward = forward.cast<float>();
  view.right = side.cast<float>();
  view.up = side.cross(forward).cast<float>();
  view.tan_y = static_cast<float>(std::tan(camera.fov * std::numbers::pi / 360));
  view.tan_x = view.tan_y * static_cast<float>(width) / static_cast<float>(height);
  view.half_height = static_cast<float>(distance) * view.tan_y;

  const float middle = view.forward.dot(bounds.center() - view.eye),
              radius = 1.01f * bounds.radius();
  view.far = std::max(middle + radius, 1e-3f * static_cast<float>(distance));
  view.near = std::max(middle - radius, 2e-3f * view.far);
  return view;
}

Mat4f clip_from_world(const PerspectiveView& view) {
  Mat4f eye_from_world = Mat4f::Identity();
  eye_from_world.block<1, 3>(0, 0) = view.right.transpose();
  eye_from_world.block<1, 3>(1, 0) = view.up.transpose();
  eye_from_world.block<1, 3>(2, 0) = view.forward.transpose();
  eye_from_world.block<3, 1>(0, 3) = -eye_from_world.block<3, 3>(0, 0) * view.eye;

  const float n = view.near, f = view.far;
  Mat4f clip = Mat4f::Zero();
  clip(0, 0) = 1 / view.tan_x;
  clip(1, 1) = -1 / view.tan_y;
  clip(0, 2) = 2 * view.shift_x / static_cast<float>(view.width);
  clip(1, 2) = 2 * view.shift_y / static_cast<float>(view.height);
  clip(2, 2) = (f + n) / (f - n);
  clip(2, 3) = -2 * f * n / (f - n);
  clip(3, 2) = 1;
  return clip * eye_from_world;
}

LightBox make_light_box(const Vec3f& direction, const Bounds3f& bounds) {
  LightBox box;
  box.direction = direction.normalized();
  const Vec3f seed = std::abs(box.direction.y()) < 0.9f ? Vec3f(0, 1, 0) : Vec3f(1, 0, 0);
  box.u = seed.cross(box.direction).normalized();
  box.v = box.direction.cross(box.u);
  const Vec3f half = bounds.empty() ? Vec3f(1, 1, 1) : Vec3f(bounds.box.sizes() * 0.5f);
  box.center = bounds.center();
  const auto extent = [&](const Vec3f& axis) { return axis.cwiseAbs().dot(half); };
  // A margin keeps the blurred silhouettes away from the border.
  box.half = std::max({extent(box.u), extent(box.v), 1e-6f}) * 1.15f;
  box.depth = std::max(extent(box.direction), 1e-6f) * 1.02f;
  return box;
}

}  // namespace rend
