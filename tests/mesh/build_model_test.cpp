// Whole scenes: placement, materials, velocities, limits.
#include "engine/mesh/build_model.h"

#include "engine/core/error.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

SceneDesc two_boxes() {
  SceneDesc scene;
  scene.grid.dx = 0.1;
  scene.materials.resize(2);
  BodyDesc box;
  box.shape = BoxDesc{Vec3(1, 0.5, 0.5)};
  scene.bodies = {box, box};
  scene.bodies[1].material = 1;
  scene.bodies[1].position = Vec3(0, 2, 0);
  scene.bodies[1].rotation = Vec3(0, 0, 90);
  scene.bodies[1].velocity = Vec3(0, -1, 0);
  scene.bodies[1].velocity_gradient(0, 1) = 3;
  return scene;
}

}  // namespace

TEST_CASE("bodies are placed, turned and moved as the scene says") {
  const SceneDesc scene = two_boxes();
  const Model m = build_model(scene);
  const std::size_t n = m.X.size();
  CHECK(m.volume.size() == n);
  CHECK(m.velocity.size() == n);
  CHECK(m.body.size() == n);
  CHECK(m.material.size() == n);
  CHECK(m.crease.size() == n);
  CHECK(m.strength.empty());
  CHECK(m.spacing == std::vector<Real>{0.05, 0.05});
  Vec3 low = Vec3::Constant(1e9), high = -low, mass_centre = Vec3::Zero();
  Real volume[2] = {0, 0};
  for (std::size_t i = 0; i < n; ++i) {
    volume[m.body[i]] += m.volume[i];
    CHECK(m.material[i] == m.body[i]);
    if (m.body[i] == 0) continue;
    low = low.cwiseMin(m.X[i]);
    high = high.cwiseMax(m.X[i]);
    mass_centre += m.volume[i] * m.X[i] / 0.25;
    const Vec3 v(3 * (m.X[i].y() - 2), -1, 0);
    if ((m.velocity[i] - v).norm() > 1e-12) FAIL("velocity of particle " << i);
  }
  CHECK(volume[0] == doctest::Approx(0.25));
  CHECK(volume[1] == doctest::Approx(0.25));
  CHECK((low - Vec3(-0.25, 1.5, -0.25)).norm() < 1e-12);
  CHECK((high - Vec3(0.25, 2.5, 0.25)).norm() < 1e-12);
  CHECK((mass_centre - Vec3(0, 2, 0)).norm() < 0.005);
  for (const Tet& t : m.tets)
    for (Index i : t) CHECK(m.body[std::size_t(i)] == m.body[std::size_t(t[0])]);
}

TEST_CASE("the estimate is right for small models and refuses huge ones before building them") {
  SceneDesc scene = two_boxes();
  const ModelEstimate e = estimate_model(scene);
  CHECK(e.particles == doctest::Approx(4000));
  CHECK(e.particles == doctest::Approx(Real(build_model(scene).X.size())).epsilon(0.05));
  scene.grid.dx = 1e-3;
  CHECK(estimate_model(scene).particles == doctest::Approx(4e9));
  try {
    build_model(scene);
    FAIL("no error");
  } catch (const Error& error) {
    CHECK(error.where() == "/grid/dx");
    CHECK(error.why().find("4e+09 particles") != std::string::npos);
    CHECK(error.why().find("limit is 16 GB") != std::string::npos);
  }
  scene.grid.dx = 1e-120;
  CHECK_THROWS_AS(build_model(scene), Error);
}

TEST_CASE("an outline that crosses itself is refused with its place") {
  SceneDesc scene = two_boxes();
  scene.bodies[1].shape = PrismDesc{{{0, 0}, {2, 1}, {2, 0}, {0, 1}}, 1};
  try {
    build_model(scene);
    FAIL("no error");
  } catch (const Error& error) {
    CHECK(error.where() == "/bodies/1/shape/outline");
  }
}

TEST_CASE("progress runs from 0 to 1") {
  std::vector<double> shares;
  build_model(two_boxes(), 16e9, [&](const char*, double share) { shares.push_back(share); });
  REQUIRE(shares.size() >= 3);
  CHECK(shares.front() == 0);
  CHECK(shares.back() == 1);
  CHECK(std::is_sorted(shares.begin(), shares.end()));
}
