// Shape of crack faces at rest: close to the surface that parted the particles, and fixed once it
// is there.
#include "engine/fracture/check_mesh.h"
#include "tests/fracture/test_meshes.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

using namespace rend;

namespace {

Vec3 stay(const Vec3& X) { return X; }

struct Face {
  Real area_ratio;  ///< over the exact area
  Real rms;         ///< distance in mean edge lengths
};

// A crack along height(u, v) over a plane through `origin`; one of its faces, measured.
Face crack_face(const Model& model, const Vec3& normal, Real amplitude, int smoothing) {
  const Vec3 n = normal.normalized();
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  Real h = 0;
  const std::vector<Edge> edges = edges_of(model);
  for (const Edge& e : edges)
    h += (model.X[e[0]] - model.X[e[1]]).norm() / static_cast<Real>(edges.size());
  const Real spacing = model.spacing[0], wave = 2 * M_PI / (10 * spacing);
  const Vec3 origin(.5, .5, .503 + .3 * spacing);
  const auto height = [&](const Vec3& X) {
    const Vec3 q = X - origin;
    return q.dot(n) - amplitude * spacing * std::sin(wave * q.dot(u)) * std::sin(wave * q.dot(v));
  };
  const auto slope = [&](const Vec3& X) {
    const Vec3 q = X - origin;
    const Real a = wave * q.dot(u), b = wave * q.dot(v), k = amplitude * spacing * wave;
    return std::hypot(1, std::hypot(k * std::cos(a) * std::sin(b), k * std::sin(a) * std::cos(b)));
  };
  SceneDesc scene = plain_scene();
  scene.fracture.smoothing_iterations = smoothing;
  FractureMesh mesh(scene, model,
                    table_of(edges_between(model, [&](const Vec3& X) { return height(X) < 0; })));
  const Snapshot rest = moved(model, stay);
  mesh.update(rest);
  const SurfaceMesh s = mesh.surface(rest);
  CHECK(check_mesh(s).good());
  Real exact = 0;
  const int q = 400;
  for (int i = 0; i < q; ++i)
    for (int j = 0; j < q; ++j) {
      const Real a = -1 + (i + .5) * 2 / q, b = -1 + (j + .5) * 2 / q;
      Vec3 X = origin + a * u + b * v;
      X -= height(X) * n;
      if (X.minCoeff() >= 0 && X.maxCoeff() <= 1) exact += 4. / (q * q) * slope(X);
    }
  Real area = 0, sum = 0;
  for (Index i = 0; i < s.triangle_count(); ++i) {
    if (!s.interior[i] || s.piece[i] != 0) continue;
    const Vec3 &a = s.x[s.triangles[i][0]], &b = s.x[s.triangles[i][1]],
               &c = s.x[s.triangles[i][2]];
    const Real part = .5 * (b - a).cross(c - a).norm();
    area += part;
    for (const Vec3& m : {Vec3(.5 * (a + b)), Vec3(.5 * (b + c)), Vec3(.5 * (c + a))})
      sum += part / 3 * std::pow(height(m) / slope(m) / h, 2);
  }
  return {area / exact, std::sqrt(sum / area)};
}

}  // namespace

TEST_CASE("faces of a plane crack are plane, of a wavy one wavy") {
  const std::pair<const char*, Model> models[] = {
      {"jittered", kuhn_box({22, 22, 22}, {1, 1, 1}, .25, 31)}, {"bcc", bcc_cube(17)}};
  for (const auto& [name, model] : models) {
    for (int n = 0; n <= 8; ++n) {
      Real area = 0, plane = 0, wavy = 0;
      const Vec3 normals[] = {{0, 0, 1}, {.36, .48, .8}, {1, -1, 1}};
      for (const Vec3& normal : normals) {
        const Face f = crack_face(model, normal, 0, n);
        area += f.area_ratio / 3;
        plane += f.rms * f.rms / 3;
      }
      for (const Vec3& normal : {normals[0], normals[1]})
        wavy += std::pow(crack_face(model, normal, 1, n).rms, 2) / 2;
      MESSAGE(name << " " << n << ": area " << area << " plane " << std::sqrt(plane) << " wavy "
                   << std::sqrt(wavy));
    }
  }
}
