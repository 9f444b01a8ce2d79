// Checks across fields.
#include "engine/scene/scene_check.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/material/law_constants.h"
#include "engine/scene/crack_band.h"
#include "engine/scene/json_value.h"

namespace rend {

namespace {

using Point = Eigen::Vector2d;

constexpr Real kMaxStepsPerFrame = 1e6;

Real cross(const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); }

Real signed_area(const std::vector<Point>& outline) {
  Real twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i)
    twice += cross(outline[i] - outline[0], outline[(i + 1) % outline.size()] - outline[0]);
  return twice / 2;
}

bool on_segment(const Point& a, const Point& b, const Point& p) {
  return cross(b - a, p - a) == 0 && (p - a).dot(p - b) <= 0;
}

bool segments_meet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto side = [](const Point& p, const Point& q, const Point& r) {
    const Real area = cross(q - p, r - p);
    return area > 0 ? 1 : area < 0 ? -1 : 0;
  };
  if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0) return true;
  return on_segment(a, b, c) || on_segment(a, b, d) || on_segment(c, d, a) || on_segment(c, d, b);
}

void check_outline(std::vector<Point>& outline, const std::string& where) {
  const std::size_t n = outline.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point &corner = outline[i], &next = outline[(i + 1) % n],
                &last = outline[(i + n - 1) % n];
    if (corner == next)
      throw Error(where, fmt::format("corners {} and {} are the same point", i, (i + 1) % n));
    if (cross(last - corner, next - corner) == 0 && (last - corner).dot(next - corner) > 0)
      throw Error(where, fmt::format("turns back on itself at corner {}", i));
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j + 1 == n) continue;  // neighbours through the closing edge
      if (segments_meet(outline[i], outline[i + 1], outline[j], outline[(j + 1) % n]))
        throw Error(
            where,
            fmt::format("is no simple polygon: the edges from corners {} and {} meet", i, j));
    }
  if (signed_area(outline) < 0) std::reverse(outline.begin(), outline.end());
}

void check_body(BodyDesc& body, const std::string& where) {
  const std::string shape = join_pointer(where, "shape");
  if (auto* prism = std::get_if<PrismDesc>(&body.shape))
    check_outline(prism->outline, shape + "/outline");
  if (const auto* torus = std::get_if<TorusDesc>(&body.shape);
      torus && torus->minor_radius >= torus->major_radius)
    throw Error(shape + "/minor_radius", fmt::format("is {}; it must be below major_radius = {} m",
                                                     torus->minor_radius, torus->major_radius));
}

void check_collider(const ColliderDesc& collider, const std::string& where) {
  if (const auto* plane = std::get_if<PlaneDesc>(&collider.shape);
      plane && plane->normal.norm() < 1e-6)
    throw Error(where + "/shape/normal", "is [0, 0, 0]; it must point out of the half space");
  for (std::size_t k = 1; k < collider.motion.size(); ++k)
    if (!(collider.motion[k].time > collider.motion[k - 1].time))
      throw Error(fmt::format("{}/motion/{}/time", where, k),
                  fmt::format("is {}; it must be above {} s, the time of the keyframe before",
                              collider.motion[k].time, collider.motion[k - 1].time));
}

void check_material(const MaterialDesc& m, const std::string& where) {
  const StrengthFieldDesc& field = m.strength_field;
  if (field.modulus == 0) return;
  if (field.modulus < 1)
    throw Error(where + "/strength_field/modulus",
                fmt::format("is {}; it must be 0 (off) or at least 1", field.modulus));
  if (field.length <= 0)
    throw Error(where + "/strength_field/length",
                "is 0; a strength field needs a correlation length above 0 m");
}

void check_camera(const CameraDesc& camera, const std::string& where) {
  const Vec3 view = camera.target - camera.eye;
  if (view.norm() < 1e-6) throw Error(where + "/eye", "is where the target is; they must differ");
  if (view.cross(Vec3::UnitY()).norm() < 1e-6 * view.norm())
    throw Error(where + "/eye",
                "lies straight above or below the target, so that no side is up; move it a little");
}

void check_time_steps(const SceneDesc& scene, const std::string& where) {
  const Real frame = 1 / scene.frame_rate;
  const Real fixed = scene.solver.time_step;
  if (fixed > frame)
    throw Error(where + "/solver/time_step",
                fmt::format("is {} s; it must not pass one frame, {} s", fixed, frame));
  if (fixed > 0 && frame / fixed > kMaxStepsPerFrame)
    throw Error(
        where + "/solver/time_step",
        fmt::format(
            "is {} s, which makes {:.3g} steps a frame; at most {:g} are allowed, from {:.3g} s",
            fixed, frame / fixed, kMaxStepsPerFrame, frame / kMaxStepsPerFrame));
  if (fixed > 0) return;
  for (const BodyDesc& body : scene.bodies) {
    const MaterialDesc& m = scene.materials[body.material];
    const Lame lame = lame_parameters(m.youngs_modulus, m.poisson_ratio);
    const Real stiffness =
        3 * lame.lambda + 2 * lame.mu;  // 3K bounds free particles, and 2 mu + lambda
    const Real step = scene.solver.cfl * scene.grid.dx * std::sqrt(m.density / stiffness);
    if (frame / step > kMaxStepsPerFrame)
      throw Error(
          where + "/grid/dx",
          fmt::format(
              "is {} m, with which the material \"{}\" needs steps of {:.3g} s, {:.3g} a frame; at "
              "most {:g} are allowed: raise dx or frame_rate, or lower youngs_modulus",
              scene.grid.dx, m.name, step, frame / step, kMaxStepsPerFrame));
  }
}

}  // namespace

void complete_scene(SceneDesc& scene, const std::string& source) {
  const std::string root = source + "#";
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    check_material(scene.materials[i], join_pointer(root + "/materials", scene.materials[i].name));
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    check_body(scene.bodies[i], fmt::format("{}/bodies/{}", root, i));
  for (std::size_t i = 0; i < scene.colliders.size(); ++i)
    check_collider(scene.colliders[i], fmt::format("{}/colliders/{}", root, i));
  check_camera(scene.camera, root + "/camera");
  check_time_steps(scene, root);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    derive_softening(scene, i, join_pointer(root + "/materials", scene.materials[i].name));
}

}  // namespace rend
