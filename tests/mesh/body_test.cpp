// Bodies made of exact solids: skin, volume, number of particles, determinism.
#include "engine/mesh/body.h"

#include "engine/mesh/clip.h"
#include "engine/mesh/solid.h"
#include "tests/mesh/sample_files.h"

#include <doctest/doctest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

using namespace rend;

namespace {

SamplingOptions options_for(const Solid& solid, Real h, Sampling pattern = Sampling::poisson) {
  return {pattern, solid.volume() / (h * h * h), 7, 0};
}

Real tet_volume(const Tet& t, const std::vector<Vec3>& X) {
  const Vec3& o = X[std::size_t(t[0])];
  return (X[std::size_t(t[1])] - o)
             .dot((X[std::size_t(t[2])] - o).cross(X[std::size_t(t[3])] - o)) /
         6;
}

// Area-weighted root mean square distance of facet points to the solid's surface.
Real rms_distance(const Body& body, const Solid& solid) {
  Real sum = 0, area = 0;
  for (const Triangle& t : body.skin) {
    const Vec3 a = body.X[std::size_t(t[0])], b = body.X[std::size_t(t[1])],
               c = body.X[std::size_t(t[2])];
    const Real w = (b - a).cross(c - a).norm();
    area += w;
    for (const Vec3& x :
         {Vec3((a + b + c) / 3), Vec3((a + b) / 2), Vec3((b + c) / 2), Vec3((c + a) / 2)})
      sum += w / 4 * std::pow(solid.distance(x), 2);
  }
  return std::sqrt(sum / area);
}

Index euler_number(const Body& body) {
  std::vector<Index> vertices;
  for (const Triangle& t : body.skin) vertices.insert(vertices.end(), t.begin(), t.end());
  std::sort(vertices.begin(), vertices.end());
  const auto v = std::unique(vertices.begin(), vertices.end()) - vertices.begin();
  return Index(v) - Index(body.skin.size()) / 2;
}

void check_sound(const Body& body, const Solid& solid, const SamplingOptions& o) {
  CHECK(body.notes.empty());
  CHECK(std::abs(Real(body.X.size()) / o.count - 1) < 0.05);
  const SkinDefects defects = find_skin_defects(body.skin);
  CHECK(defects.edges.empty());
  CHECK(defects.vertices.empty());
  auto from_tets = skin_of(body.tets), stored = body.skin;
  const auto turned = [](std::vector<Triangle>& skin) {
    for (Triangle& t : skin) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(skin.begin(), skin.end());
  };
  turned(from_tets);
  turned(stored);
  CHECK(from_tets == stored);
  std::vector<char> used(body.X.size(), 0);
  Real total = 0;
  bool positive = true;
  for (const Tet& t : body.tets) {
    total += tet_volume(t, body.X);
    positive = positive && tet_volume(t, body.X) > 0;
    for (Index i : t) used[std::size_t(i)] = 1;
  }
  CHECK(positive);
  CHECK(std::count(used.begin(), used.end(), 0) == 0);
  Real mass = 0;
  for (Real v : body.volume) mass += v;
  CHECK(mass == doctest::Approx(solid.volume()).epsilon(1e-10));
  // Outward and closed: the skin encloses exactly the tets.
  CHECK(enclosed_volume({body.X, body.skin}) == doctest::Approx(total).epsilon(1e-10));
  for (const Vec3& x : body.X)
    if (solid.distance(x) > 1e-12) FAIL("particle outside");
}

const std::vector<Eigen::Vector2d> l_outline = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};

}  // namespace

TEST_CASE("curved bodies: closed skin near the shape, right count, exact volume") {
  const auto sphere = make_sphere({1.0});
  const auto torus = make_torus({0.7, 0.25});
  const auto cylinder = make_cylinder({0.5, 1.2});
  for (Sampling pattern : {Sampling::lattice, Sampling::jittered, Sampling::poisson}) {
    CAPTURE(int(pattern));
    const Real h = 0.05;
    for (const Solid* solid : {sphere.get(), torus.get(), cylinder.get()}) {
      const SamplingOptions o = options_for(*solid, h, pattern);
      const Body body = build_body(*solid, o);
      check_sound(body, *solid, o);
      CHECK(rms_distance(body, *solid) < 0.03 * h);
      CHECK(euler_number(body) == (solid == torus.get() ? 0 : 2));
    }
  }
}

TEST_CASE("flat faces and sharp edges are exact") {
  const auto box = make_box({Vec3(1.4, 1, 0.8)});
  const auto prism = make_prism({l_outline, 0.8});
  for (Sampling pattern : {Sampling::lattice, Sampling::jittered, Sampling::poisson}) {
    CAPTURE(int(pattern));
    for (const Solid* solid : {box.get(), prism.get()}) {
      const SamplingOptions o = options_for(*solid, 0.08, pattern);
      const Body body = build_body(*solid, o);
      check_sound(body, *solid, o);
      CHECK(rms_distance(body, *solid) < 1e-12);
      CHECK(enclosed_volume({body.X, body.skin}) == doctest::Approx(solid->volume()).epsilon(1e-9));
      CHECK(euler_number(body) == 2);
    }
  }
}

TEST_CASE("crease marks the corners and edges of a box and nothing else") {
  const auto box = make_box({Vec3(1, 1, 1)});
  const Body body = build_body(*box, options_for(*box, 0.1));
  for (std::size_t i = 0; i < body.X.size(); ++i) {
    const auto at_face = (body.X[i].array().abs() > 0.5 - 1e-12).count();
    if ((at_face >= 2) != bool(body.crease[i])) FAIL("wrong crease mark at particle " << i);
  }
  CHECK(std::count(body.crease.begin(), body.crease.end(), 1) >= 8 + 12 * 8);
}

TEST_CASE("a slanted prism keeps its notch") {
  const std::vector<Eigen::Vector2d> arrow = {{0, 0}, {2, -1.1}, {1.1, 0.2}, {1.7, 1.3}};
  const auto solid = make_prism({arrow, 0.6});
  const SamplingOptions o = options_for(*solid, 0.07);
  const Body body = build_body(*solid, o);
  check_sound(body, *solid, o);
  CHECK(rms_distance(body, *solid) < 1e-9);
  CHECK(enclosed_volume({body.X, body.skin}) == doctest::Approx(solid->volume()).epsilon(1e-6));
}

TEST_CASE("a wall of two spacings is solid") {
  const auto wall = make_box({Vec3(2, 2, 0.1)});
  const SamplingOptions o = options_for(*wall, 0.05);
  const Body body = build_body(*wall, o);
  check_sound(body, *wall, o);
  CHECK(rms_distance(body, *wall) < 1e-12);
}

TEST_CASE("the same seed gives the same bits, another seed does not") {
  const auto torus = make_torus({0.7, 0.25});
  SamplingOptions o = options_for(*torus, 0.08);
  const Body a = build_body(*torus, o), b = build_body(*torus, o);
  CHECK(a.X == b.X);
  CHECK(a.tets == b.tets);
  o.seed = 8;
  CHECK(build_body(*torus, o).X != a.X);
}

TEST_CASE("poisson samples keep their distance") {
  const auto box = make_box({Vec3(1, 1, 1)});
  const Samples s = sample_solid(*box, options_for(*box, 0.1));
  Real nearest = 1e300;
  for (std::size_t i = 0; i < s.X.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, (s.X[i] - s.X[j]).norm());
  CHECK(nearest > 0.8 * s.spacing);
}

TEST_CASE("a wall of one spacing still closes") {
  const auto wall = make_box({Vec3(2, 2, 0.1)});
  const SamplingOptions o = options_for(*wall, 0.1);
  const Body body = build_body(*wall, o);
  check_sound(body, *wall, o);
  CHECK(rms_distance(body, *wall) < 1e-12);
}

TEST_CASE("concave surfaces do not fill up with flat tets") {
  const auto torus = make_torus({0.7, 0.25});
  const Body body = build_body(*torus, options_for(*torus, 0.05));
  // Smallest of the six dihedral angles below 5 degrees.
  const auto is_sliver = [&](const Tet& t) {
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const std::size_t k = i != 0 && j != 0 ? 0 : (i != 1 && j != 1 ? 1 : 2), l = 6 - i - j - k;
        const auto x = [&](std::size_t v) { return body.X[std::size_t(t[v])]; };
        const Vec3 edge = x(j) - x(i), a = edge.cross(x(k) - x(i)), b = edge.cross(x(l) - x(i));
        if (a.dot(b) > std::cos(5 * M_PI / 180) * a.norm() * b.norm()) return true;
      }
    return false;
  };
  const auto slivers = std::count_if(body.tets.begin(), body.tets.end(), is_sliver);
  CHECK(Real(slivers) < 0.006 * Real(body.tets.size()));
}

TEST_CASE("the skin stays a closed manifold where samples are too coarse for the shape") {
  std::vector<Eigen::Vector2d> star;
  for (int i = 0; i < 32; ++i) {
    const Real r = i % 2 ? 0.35 : 1, a = M_PI * i / 16;
    star.emplace_back(r * std::cos(a), r * std::sin(a));
  }
  const auto solid = make_prism({star, 0.4});
  const Samples samples = sample_solid(*solid, options_for(*solid, 0.1));
  const ClippedTets clipped = clip_to_solid(delaunay(samples.X), samples, *solid);
  CHECK(clipped.manifold_repairs > 0);
  CHECK(clipped.open_defects == 0);
  const SkinDefects defects = find_skin_defects(clipped.skin);
  CHECK(defects.edges.empty());
  CHECK(defects.vertices.empty());
  CHECK(std::count(clipped.used.begin(), clipped.used.end(), 0) < 10);
}

TEST_CASE("volume of mesh solids: exact however thin, overlapping parts once") {
  for (const Vec3& size : {Vec3(20, 1, 1), Vec3(1, 1, 0.02), Vec3(1, 0.05, 1), Vec3(1000, 1, 1)}) {
    TriangleSurface box = cube_surface();
    for (Vec3& x : box.positions) x = x.cwiseProduct(size);
    CAPTURE(size.transpose());
    CHECK(make_mesh_solid(box, size.y())->volume() == doctest::Approx(size.prod()).epsilon(1e-12));
  }
  const auto apart = make_mesh_solid(merged(cube_surface(), cube_surface(Vec3(5, 0, 0))), 1);
  CHECK(apart->volume() == doctest::Approx(2).epsilon(1e-12));
  const auto crossing =
      make_mesh_solid(merged(cube_surface(), cube_surface(Vec3(0.5, 0.5, 0.5))), 1.5);
  CHECK(crossing->volume() == doctest::Approx(2 - 0.125).epsilon(0.01));
}
