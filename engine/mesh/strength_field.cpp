// Random cosines, one set a material.
#include "engine/mesh/strength_field.h"

#include "engine/core/parallel.h"
#include "engine/core/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rend {

namespace {

using std::numbers::pi;

constexpr int wave_count = 256;
// Streams of the bodies' samples start at 0.
constexpr std::uint64_t first_stream = 1ull << 32;

// Box and Muller's pair, one of the two.
Real normal_number(Real u, Real v) {
  return std::sqrt(-2 * std::log(1 - u)) * std::cos(2 * pi * v);
}

class GaussianField {
 public:
  GaussianField(Real length, Random random) {
    for (int w = 0; w < wave_count; ++w) {
      Wave wave;
      for (int k = 0; k < 3; ++k) {
        const Real u = random.next(), v = random.next();
        wave.vector[k] = normal_number(u, v) / length;
      }
      wave.phase = random.next(0, 2 * pi);
      waves_.push_back(wave);
    }
  }
  Real operator()(const Vec3& x) const {
    Real sum = 0;
    for (const Wave& w : waves_) sum += std::cos(w.vector.dot(x) + w.phase);
    return std::sqrt(2.0 / wave_count) * sum;
  }

 private:
  struct Wave {
    Vec3 vector;
    Real phase;
  };
  std::vector<Wave> waves_;
};

Real weibull_factor(Real z, Real modulus) {
  const Real survival = 0.5 * std::erfc(std::clamp(z, -6.0, 6.0) / std::numbers::sqrt2);
  return std::pow(-std::log(survival), 1 / modulus) / std::tgamma(1 + 1 / modulus);
}

}  // namespace

std::vector<float> strength_factors(const SceneDesc& scene, const Model& model) {
  const auto varies = [](const MaterialDesc& m) { return m.strength_field.modulus > 0; };
  const bool used = std::any_of(model.material.begin(), model.material.end(),
                                [&](std::uint16_t m) { return varies(scene.materials[m]); });
  if (!used) return {};
  std::vector<float> factor(model.X.size(), 1);
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const StrengthFieldDesc& desc = scene.materials[m].strength_field;
    if (!varies(scene.materials[m])) continue;
    const Random random(scene.seed, first_stream + m);
    const bool smooth = desc.length > 0;
    const GaussianField field(smooth ? desc.length : 1, random);
    parallel_for(model.particle_count(), 1024, [&](Index i) {
      const auto p = std::size_t(i);
      if (model.material[p] != m) return;
      const std::uint64_t n = 2 * std::uint64_t(i);
      const Real z =
          smooth ? field(model.X[p]) : normal_number(random.uniform(n), random.uniform(n + 1));
      factor[p] = float(weibull_factor(z, desc.modulus));
    });
  }
  return factor;
}

}  // namespace rend
