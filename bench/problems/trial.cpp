// Runs on the clock.
#include "bench/problems/trial.h"

#include "engine/core/small_matrix.h"
#include "engine/core/stopwatch.h"
#include "engine/mpm/reference_solver.h"
#include "engine/mpm/tile_solver.h"

#include <chrono>

namespace rend {

Trial::Trial(const SceneDesc& scene, const Model& model) : scene_(scene) {
  if (scene.solver.precision == Precision::float32)
    solver_ = std::make_unique<TileSolver>(scene, model);
  else
    solver_ = std::make_unique<ReferenceSolver>(scene, model);
  cost_.particles = model.particle_count();
  cost_.bytes_per_particle = solver_->bytes_per_particle();
}

FrameReport Trial::advance(Real duration) {
  const auto begin = std::chrono::steady_clock::now();
  FrameReport report;
  {
    const Stopwatch clock(cost_.cpu_seconds);
    report = solver_->advance(duration);
  }
  cost_.wall_seconds +=
      std::chrono::duration<Real>(std::chrono::steady_clock::now() - begin).count();
  cost_.steps += report.substeps;
  cost_.status = report.status;
  return report;
}

Matter Trial::matter() const {
  if (const auto* reference = dynamic_cast<const ReferenceSolver*>(solver_.get()))
    return {reference->particles().x, reference->particles().v, reference->particles().tau,
            reference->particles().C, reference->particles().tau_c};
  Matter out;
  for (const TileSolver::Point& p : static_cast<const TileSolver&>(*solver_).points()) {
    const MaterialDesc& m = scene_.materials[0];
    const Lame lame = lame_parameters(m.youngs_modulus, m.poisson_ratio);
    const SymmetricEigen b = symmetric_eigen(p.strain);
    const Vec3 hencky = 0.5 * b.value.array().log1p();
    const Vec3 tau = 2 * lame.mu * hencky + Vec3::Constant(lame.lambda * hencky.sum());
    out.x.push_back(p.x);
    out.v.push_back(p.v);
    out.C.push_back(p.C);
    out.tau_c.push_back(p.tau_c);
    out.tau.push_back(b.U * tau.asDiagonal() * b.U.transpose());
  }
  return out;
}

}  // namespace rend
