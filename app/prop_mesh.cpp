// Triangles of a collider.
#include "app/prop_mesh.h"

#include <cmath>
#include <numbers>

namespace rend {

namespace {

/// Rings of a surface of revolution about y: (radius, y) from bottom to top, closed at both ends.
void add_revolution(Prop& prop, const std::vector<std::pair<Real, Real>>& profile, int sides) {
  const auto ring_start = [&](std::size_t ring) { return static_cast<Index>(ring) * sides; };
  for (const auto& [radius, y] : profile)
    for (int k = 0; k < sides; ++k) {
      const Real angle = 2 * std::numbers::pi * k / sides;
      prop.x.push_back(Vec3(radius * std::cos(angle), y, radius * std::sin(angle)).cast<float>());
    }
  for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring)
    for (int k = 0; k < sides; ++k) {
      const Index a = ring_start(ring) + k, b = ring_start(ring) + (k + 1) % sides;
      const Index c = ring_start(ring + 1) + k, d = ring_start(ring + 1) + (k + 1) % sides;
      prop.triangles.push_back({a, c, b});
      prop.triangles.push_back({b, c, d});
    }
}

void add_box(Prop& prop, const Vec3& size) {
  for (int axis = 0; axis < 3; ++axis)
    for (int side = -1; side <= 1; side += 2) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const Index first = static_cast<Index>(prop.x.size());
      for (int corner = 0; corner < 4; ++corner) {
        Vec3 x;
        x[axis] = side;
        x[u] = (corner == 1 || corner == 2) ? 1 : -1;
        x[v] = corner >= 2 ? 1 : -1;
        prop.x.push_back((0.5 * x.cwiseProduct(size)).cast<float>());
      }
      const Index a = first, b = first + 1, c = first + 2, d = first + 3;
      if (side > 0) {
        prop.triangles.push_back({a, b, c});
        prop.triangles.push_back({a, c, d});
      } else {
        prop.triangles.push_back({a, c, b});
        prop.triangles.push_back({a, d, c});
      }
    }
}

struct AddShape {
  Prop& prop;

  void operator()(const PlaneDesc&) const {}
  void operator()(const BoxDesc& box) const { add_box(prop, box.size); }
  void operator()(const CylinderDesc& c) const {
    const Real h = c.height / 2;
    add_revolution(prop, {{0, -h}, {c.radius, -h}, {c.radius, -h}, {c.radius, h}, {c.radius, h}, {0, h}}, 64);
  }
  void operator()(const SphereDesc& s) const {
    std::vector<std::pair<Real, Real>> profile;
    constexpr int kRings = 32;
    for (int k = 0; k <= kRings; ++k) {
      const Real angle = std::numbers::pi * (static_cast<Real>(k) / kRings - 0.5);
      profile.emplace_back(s.radius * std::cos(angle), s.radius * std::sin(angle));
    }
    add_revolution(prop, profile, 64);
  }
};

}  // namespace

std::optional<Prop> make_prop(const ColliderDesc& collider, Real time) {
  const bool released = collider.release_time >= 0 && time >= collider.release_time;
  if (!collider.visible || released || std::holds_alternative<PlaneDesc>(collider.shape)) return std::nullopt;
  Prop prop;
  std::visit(AddShape{prop}, collider.shape);
  const RigidPose pose = pose_at(collider.motion, time);
  for (Vec3f& x : prop.x) x = pose.to_world(x.cast<Real>()).cast<float>();
  return prop;
}

}  // namespace rend
