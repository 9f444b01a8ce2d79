// What lies under a point of the picture.
#include "app/pixel_probe.h"

#include "app/prop_mesh.h"
#include "engine/material/law_constants.h"
#include "render/pixel_ray.h"

#include <Eigen/Geometry>

#include <cmath>
#include <limits>

namespace rend {

namespace {

constexpr Real kNowhere = std::numeric_limits<Real>::infinity();

struct Ray {
  Vec3 from, along;
};

struct TriangleHit {
  Real depth = kNowhere;  ///< in units of Ray::along
  Vec3 weight = Vec3::Zero();
};

/// Moeller and Trumbore (1997), from both sides.
TriangleHit meet(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, side = ray.along.cross(ac);
  const Real det = ab.dot(side);
  if (det == 0) return {};
  const Vec3 off = ray.from - a, normal = off.cross(ab);
  const Real u = off.dot(side) / det, v = ray.along.dot(normal) / det, depth = ac.dot(normal) / det;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && depth > 0)) return {};
  return {depth, Vec3(1 - u - v, u, v)};
}

Real depth_of_props(const Stage& stage, Real time, const Ray& ray) {
  Real nearest = kNowhere;
  for (const ColliderDesc& collider : stage.scene.colliders) {
    const std::optional<Prop> prop = make_prop(collider, time);
    if (!prop) continue;
    const auto corner = [&](Index i) -> Vec3 {
      return prop->x[static_cast<std::size_t>(i)].cast<Real>();
    };
    for (const Triangle& t : prop->triangles)
      nearest = std::min(nearest, meet(ray, corner(t[0]), corner(t[1]), corner(t[2])).depth);
  }
  return nearest;
}

/// Fills in place and fragment of the surface that the ray meets before `limit`.
bool find_on_surface(const SurfaceMesh& surface, const Ray& ray, Real limit, ProbedMatter& out) {
  TriangleHit nearest{limit, Vec3::Zero()};
  std::size_t found = surface.triangles.size();
  const auto at = [](const std::vector<Vec3>& points, Index i) {
    return points[static_cast<std::size_t>(i)];
  };
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Triangle& k = surface.triangles[t];
    const TriangleHit hit =
        meet(ray, at(surface.x, k[0]), at(surface.x, k[1]), at(surface.x, k[2]));
    if (!(hit.depth < nearest.depth)) continue;
    nearest = hit;
    found = t;
  }
  if (found == surface.triangles.size()) return false;
  const Triangle& k = surface.triangles[found];
  out.position = ray.from + nearest.depth * ray.along;
  for (int c = 0; c < 3; ++c)
    out.rest += nearest.weight[c] * at(surface.rest, k[static_cast<std::size_t>(c)]);
  out.piece = surface.piece[found];
  out.crack = surface.interior[found] != 0;
  return true;
}

bool find_among_particles(const std::vector<Vec3>& x, Real radius, const Ray& ray, Real limit,
                          ProbedMatter& out) {
  const Real length2 = ray.along.squaredNorm();
  for (std::size_t p = 0; p < x.size(); ++p) {
    const Real middle = (x[p] - ray.from).dot(ray.along) / length2;
    const Real room = radius * radius - (ray.from + middle * ray.along - x[p]).squaredNorm();
    if (room < 0) continue;
    const Real depth = middle - std::sqrt(room / length2);
    if (!(depth > 0 && depth < limit)) continue;
    limit = depth;
    out.particle = static_cast<Index>(p);
    out.position = ray.from + depth * ray.along;
  }
  return out.particle >= 0;
}

Index nearest_to(const std::vector<Vec3>& points, const Vec3& x) {
  Index nearest = -1;
  Real least = kNowhere;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Real distance2 = (points[p] - x).squaredNorm();
    if (!(distance2 < least)) continue;
    least = distance2;
    nearest = static_cast<Index>(p);
  }
  return nearest;
}

}  // namespace

std::optional<ProbedMatter> probe_pixel(const Stage& stage, const Model& model, const Frame& frame,
                                        const View& view, Real x, Real y) {
  const Snapshot& snapshot = *frame.snapshot;
  const Ray ray{view.camera.eye, pixel_ray(view.camera, view.width, view.height, x, y)};
  const Real limit = depth_of_props(stage, snapshot.time, ray);
  ProbedMatter out;
  if (view.particles) {
    if (!find_among_particles(snapshot.x, particle_radius(stage), ray, limit, out))
      return std::nullopt;
    out.rest = model.X[static_cast<std::size_t>(out.particle)];
  } else {
    if (!find_on_surface(*frame.surface, ray, limit, out)) return std::nullopt;
    out.particle = nearest_to(model.X, out.rest);
  }
  const auto p = static_cast<std::size_t>(out.particle);
  const MaterialDesc& material = stage.scene.materials[model.material[p]];
  out.material = material.name;
  out.velocity = snapshot.v[p].cast<Real>();
  out.damage = snapshot.damage[p];
  out.stress = snapshot.stress[p];
  out.yielded = snapshot.yielded[p] != 0;
  if (frame.nearness && p < frame.nearness->size()) out.nearness = (*frame.nearness)[p];
  if (!yield_surface_parameters(material.yield_surface.type).empty())
    out.threshold = (1 - out.damage) * initial_threshold(material.yield_surface) *
                    (model.strength.empty() ? 1 : static_cast<Real>(model.strength[p]));
  return out;
}

}  // namespace rend
