// The stretching box of the solver benchmarks.
#include "bench/solver_problem.h"

#include "engine/core/random.h"

#include <cmath>

namespace rend {

SceneDesc bench_scene(const char* surface) {
  SceneDesc scene;
  scene.grid.dx = 1;
  scene.gravity.setZero();
  scene.solver.time_step = kBenchTimeStep;
  MaterialDesc material;
  material.density = 1;
  material.youngs_modulus = 1e4;
  material.poisson_ratio = 0.3;
  material.yield_surface.type = find_yield_surface(surface).value();
  material.yield_surface.value[0] = 154;
  scene.materials.push_back(material);
  return scene;
}

Model bench_model(int cells) {
  Model model;
  Random random(1, 1);
  const Real half = 0.5 * cells;
  Mat3 L;
  L << 1, -0.5, 0.2, 0.5, -0.6, 0.1, 0.3, 0, -0.5;
  L = (6 / half * L).cast<float>().cast<Real>();
  for (int i = 0; i < 2 * cells; ++i)
    for (int j = 0; j < 2 * cells; ++j)
      for (int k = 0; k < 2 * cells; ++k) {
        Vec3 x;
        for (int a = 0; a < 3; ++a)
          x[a] = 12 + 0.5 * ((a == 0 ? i : a == 1 ? j : k) + 0.5 + 0.6 * (random.next() - 0.5));
        x = (x * 0x1p16).array().round() * 0x1p-16;
        const Vec3 X = x - Vec3::Constant(12 + half);
        const Vec3 wave(std::sin(3 * X[0] / half), std::sin(3 * X[1] / half + 1),
                        std::sin(3 * X[2] / half + 2));
        model.X.push_back(x);
        model.velocity.push_back((L * X + 0.5 * wave).cast<float>().cast<Real>());
      }
  for (std::size_t i = model.X.size(); i > 1; --i) {
    const auto j = static_cast<std::size_t>(random.next() * static_cast<Real>(i));
    std::swap(model.X[i - 1], model.X[j]);
    std::swap(model.velocity[i - 1], model.velocity[j]);
  }
  model.volume.assign(model.X.size(), 0.125);
  model.body.assign(model.X.size(), 0);
  model.material.assign(model.X.size(), 0);
  model.velocity_gradient.push_back(L);
  return model;
}

}  // namespace rend
