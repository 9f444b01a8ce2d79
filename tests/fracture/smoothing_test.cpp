// Shape of crack faces at rest: close to the surface that parted the particles, and fixed once it
// is there.
#include "engine/fracture/check_mesh.h"
#include "engine/mesh/build_model.h"
#include "tests/fracture/test_meshes.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <string>

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

// Largest distance between the vertices of two surfaces that may be numbered differently.
Real corner_distance(const SurfaceMesh& a, const SurfaceMesh& b) {
  const auto sorted = [](const SurfaceMesh& m) {
    std::vector<std::array<Real, 6>> list;
    for (std::size_t v = 0; v < m.x.size(); ++v)
      list.push_back(
          {m.rest[v].x(), m.rest[v].y(), m.rest[v].z(), m.x[v].x(), m.x[v].y(), m.x[v].z()});
    std::sort(list.begin(), list.end());
    return list;
  };
  const auto p = sorted(a), q = sorted(b);
  if (p.size() != q.size()) return std::numeric_limits<Real>::infinity();
  Real worst = 0;
  for (std::size_t v = 0; v < p.size(); ++v)
    for (int k = 0; k < 6; ++k) worst = std::max(worst, std::abs(p[v][k] - q[v][k]));
  return worst;
}

}  // namespace

TEST_CASE("faces of a plane crack are plane, of a wavy one wavy") {
  SceneDesc scene = plain_scene();
  scene.bodies[0].shape = BoxDesc{Vec3::Ones()};
  scene.bodies[0].position = Vec3::Constant(.5);
  scene.grid.dx = 2. / 22;
  const std::pair<std::string, Model> models[] = {
      {"jittered", kuhn_box({22, 22, 22}, {1, 1, 1}, .25, 31)},
      {"body-centred", bcc_cube(17)},
      {"poisson", build_model(scene)}};
  for (const auto& [name, model] : models) {
    CAPTURE(name);
    Real plane = 0, raw = 0, wavy = 0;
    const Vec3 normals[] = {{0, 0, 1}, {.36, .48, .8}, {1, -1, 1}};
    for (const Vec3& normal : normals) {
      const Face face = crack_face(model, normal, 0, 5);
      CHECK(face.area_ratio == doctest::Approx(1).epsilon(.02));
      plane += face.rms * face.rms / 3;
      raw += std::pow(crack_face(model, normal, 0, 0).rms, 2) / 3;
    }
    for (const Vec3& normal : {normals[0], normals[1]})
      wavy += std::pow(crack_face(model, normal, 1, 5).rms, 2) / 2;
    CHECK(std::sqrt(plane) <= .085);
    CHECK(std::sqrt(plane) < .6 * std::sqrt(raw));
    CHECK(std::sqrt(wavy) <= .14);
    if (std::getenv("REND_SHOW_FIGURES"))
      MESSAGE(name << ": rms / h of a plane " << std::sqrt(plane) << " (raw " << std::sqrt(raw)
                   << "), of a wavy face " << std::sqrt(wavy));
  }
}

TEST_CASE(
    "played back with the final set, what frames share never moves and order does not matter") {
  const Model model = kuhn_box({8, 8, 8}, {1, 1, 1}, .25, 32);
  const auto side = [](const Vec3& X) { return X.z() + .1 * std::sin(9 * X.y()) < .5; };
  // All of it turns, and in frame 3 one particle is thrown out on its own.
  const Index thrown = (4 * 9 + 4) * 9 + 7;
  std::vector<Snapshot> frames;
  for (Index f = 0; f < 8; ++f) {
    const Eigen::AngleAxisd turn(.2 * f, Vec3(1, 2, 3).normalized());
    frames.push_back(moved(
        model,
        [&](const Vec3& X) {
          const Real open = std::clamp(f / 4. - X.x(), 0., 1.);
          return Vec3(turn * (X + (side(X) ? -.15 : .15) * open * Vec3(.3, 0, 1)));
        },
        f));
    if (f >= 3) frames.back().x[thrown] += Vec3(2, 0, 0);
  }
  FractureMesh live(plain_scene(), model);
  std::vector<Index> broken_then;
  for (const Snapshot& now : frames) {
    live.update(now);
    broken_then.push_back(live.report().broken_edges);
  }
  REQUIRE(broken_then[2] < broken_then.back());
  REQUIRE(live.crack().linked(thrown).empty());
  FractureMesh again = live.playback(live.break_table());
  std::map<Index, Real> where;  // edge -> share of the edge at which it is cut
  std::vector<SurfaceMesh> forward;
  for (const Snapshot& now : frames) {
    again.update(now);
    CHECK(again.report().broken_edges == broken_then[now.frame]);
    for (const BrokenEdge& b : again.crack().broken_edges()) {
      const auto [at, fresh] = where.emplace(b.edge, b.t);
      CHECK(at->second == b.t);
    }
    forward.push_back(again.surface(now));
    CHECK(check_mesh(forward.back()).good());
  }
  for (Index f : {5, 1, 7, 0, 3}) {
    again.update(frames[f]);
    const SurfaceMesh surface = again.surface(frames[f]);
    CHECK(surface.triangle_count() == forward[f].triangle_count());
    CHECK(corner_distance(surface, forward[f]) < 1e-9);
  }
}

TEST_CASE(
    "random cracks: every middle between its particles, every rim on the skin it was cut from") {
  const Model model = kuhn_box({8, 8, 8}, {1, 1, 1}, .25, 33);
  SceneDesc scene = plain_scene();
  for (int smoothing : {2, 5, 20}) {
    scene.fracture.smoothing_iterations = smoothing;
    std::vector<Edge> edges = edges_of(model);
    std::erase_if(edges, [&](const Edge& e) { return (7 * e[0] + 3 * e[1]) % 10 >= 3; });
    FractureMesh mesh(scene, model, table_of(edges));
    const Snapshot rest = moved(model, stay);
    mesh.update(rest);
    for (const BrokenEdge& b : mesh.crack().broken_edges())
      REQUIRE(std::abs(b.t - .5) <= .45 + 1e-12);
    const SurfaceMesh s = mesh.surface(rest);
    const auto to_skin = [](const Vec3& X) {
      return std::min(X.cwiseAbs().minCoeff(), (Vec3::Ones() - X).cwiseAbs().minCoeff());
    };
    Real worst = 0;
    std::size_t rim = 0;
    for (Index i = 0; i < s.triangle_count(); ++i)
      if (!s.interior[i])
        for (Index v : s.triangles[i]) worst = std::max(worst, to_skin(s.rest[v])), ++rim;
    CHECK(rim > 1000);
    CHECK(worst < 1e-14);
  }
}

TEST_CASE("live, a crack vertex rests after three frames") {
  const Model model = kuhn_box({8, 8, 8}, {1, 1, 1}, .25, 33);
  FractureMesh mesh(plain_scene(), model);
  std::map<Index, std::pair<Index, Real>> seen;
  for (Index f = 0; f < 12; ++f) {
    const Snapshot now = moved(
        model,
        [&](const Vec3& X) {
          const Real open = std::clamp(f / 6. - X.x(), 0., 1.);
          return Vec3(X + (X.z() < .47 ? -.2 : .2) * open * Vec3(0, .3, 1));
        },
        f);
    mesh.update(now);
    for (const BrokenEdge& b : mesh.crack().broken_edges()) {
      auto& [since, t] = seen.emplace(b.edge, std::pair(f, b.t)).first->second;
      if (f > since + 3) CHECK(t == b.t);
      t = b.t;
    }
  }
  CHECK(seen.size() > 100);
}
