// Camera maths in single precision: the frame of the eye, rays through pixels, projection.
#pragma once

#include "render/gbuffer.h"
#include "render/renderer.h"

#include <Eigen/Geometry>

namespace rend {

using Mat4f = Eigen::Matrix4f;

/// Smallest box around finite points; empty when nothing was added.
struct Bounds3f {
  Eigen::AlignedBox3f box;
  void add(const Vec3f& p) {
    if (p.allFinite()) box.extend(p);
  }
  bool empty() const { return box.isEmpty(); }
  Vec3f center() const { return empty() ? Vec3f(0, 0, 0) : Vec3f(box.center()); }
  float radius() const { return empty() ? 1.0f : std::max(0.5f * box.diagonal().norm(), 1e-6f); }
};

/// A perspective view; a point at view depth z (along `forward`) under pixel (x, y) counted from
/// the top left is eye + z (forward + u(x) right + v(y) up).
struct PerspectiveView {
  int width = 1, height = 1;
  Vec3f eye, right, up, forward;
  float tan_x = 1, tan_y = 1;      ///< tangents of the half angles
  float near = 0.1f, far = 10;     ///< view depths of the clip planes
  float shift_x = 0, shift_y = 0;  ///< the picture is moved by this much [pixel]
  float half_height = 1;           ///< half of the visible height at the target [m]
};

/// @throws Error when the camera is not finite, has no direction or an angle outside 1..150
/// degrees.
PerspectiveView make_view(const Camera& camera, int width, int height, const Bounds3f& bounds);

/// World to clip space with y pointing down, so that framebuffer rows run from the top of the
/// picture.
Mat4f clip_from_world(const PerspectiveView& view);

/// Frame of an orthographic view from `direction` (towards the light) that covers `bounds`.
LightBox make_light_box(const Vec3f& direction, const Bounds3f& bounds);

}  // namespace rend
