// The strength field has Weibull's mean and spread, its correlation length, and follows the seed.
#include "engine/mesh/strength_field.h"

#include "engine/core/random.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace rend;

namespace {

SceneDesc scene_with(Real modulus, Real length) {
  SceneDesc scene;
  scene.materials.resize(2);
  scene.materials[1].strength_field = {modulus, length};
  return scene;
}

Model points(std::uint16_t material, int n = 20000) {
  Model m;
  Random random(3, 3);
  for (int i = 0; i < n; ++i) {
    const Real x = random.next(), y = random.next(), z = random.next();
    m.X.emplace_back(x, y, z);
    m.material.push_back(material);
  }
  return m;
}

struct Moments {
  Real mean = 0, deviation = 0;
};

Moments moments(const std::vector<float>& f) {
  Real sum = 0, squares = 0;
  for (float v : f) {
    sum += v;
    squares += Real(v) * v;
  }
  const Real mean = sum / Real(f.size());
  return {mean, std::sqrt(squares / Real(f.size()) - mean * mean)};
}

}  // namespace

TEST_CASE("uniform materials need no field") {
  CHECK(strength_factors(scene_with(5, 0.1), points(0)).empty());
  CHECK(strength_factors(scene_with(0, 0.1), points(1)).empty());
}

TEST_CASE("mean 1 and the spread of the Weibull modulus") {
  for (Real m : {2.0, 8.0})
    for (Real length : {0.0, 0.03}) {
      const Moments got = moments(strength_factors(scene_with(m, length), points(1)));
      const Real g = std::tgamma(1 + 1 / m);
      CHECK(got.mean == doctest::Approx(1).epsilon(0.03));
      CHECK(got.deviation ==
            doctest::Approx(std::sqrt(std::tgamma(1 + 2 / m) / (g * g) - 1)).epsilon(0.07));
    }
}

TEST_CASE("values agree well below the correlation length and not beyond it") {
  const SceneDesc scene = scene_with(3, 0.05);
  const Model a = points(1);
  const auto fa = strength_factors(scene, a);
  const auto correlation = [&](Real distance) {
    Model b = a;
    for (Vec3& x : b.X) x.x() += distance;
    const auto fb = strength_factors(scene, b);
    const Moments ma = moments(fa), mb = moments(fb);
    Real sum = 0;
    for (std::size_t i = 0; i < fa.size(); ++i) sum += (fa[i] - ma.mean) * (fb[i] - mb.mean);
    return sum / Real(fa.size()) / (ma.deviation * mb.deviation);
  };
  CHECK(correlation(0.005) > 0.98);
  CHECK(correlation(0.05) == doctest::Approx(std::exp(-0.5)).epsilon(0.15));
  CHECK(std::abs(correlation(0.2)) < 0.15);
}

TEST_CASE("the seed decides, and untouched materials keep strength 1") {
  SceneDesc scene = scene_with(4, 0.1);
  Model m = points(1, 100);
  m.material[7] = 0;
  const auto first = strength_factors(scene, m);
  CHECK(first[7] == 1.0f);
  CHECK(first == strength_factors(scene, m));
  scene.seed = 2;
  CHECK(first != strength_factors(scene, m));
}
