// Driven blocks.
#include "bench/problems/driven_block.h"

#include "bench/problems/lattice_model.h"
#include "engine/core/small_matrix.h"
#include "engine/material/law_constants.h"

#include <algorithm>
#include <cmath>

namespace rend {

DrivenResult drive(const SolverDesc& solver, SofteningRule rule, DrivenPath path, Index steps) {
  const bool rankine = path == DrivenPath::uniaxial_strain;
  const Real tau_c = 5, alpha = 16;
  SceneDesc scene = plain_scene();
  scene.solver = solver;
  scene.materials[0] =
      with_surface(scene.materials[0], rankine ? "rankine" : "von_mises", tau_c, alpha);
  scene.materials[0].softening_rule = rule;
  const Lame lame = lame_parameters(scene.materials[0].youngs_modulus, 0.3);
  // Stress grows with M (or 2 mu) per unit of the measure of strain, and falls with
  // alpha M / (M - alpha) once it yields, until tau_c / 2 is left.
  const Real M = rankine ? lame.lambda + 2 * lame.mu : 2 * lame.mu;
  const Real measure = tau_c / M + 0.5 * tau_c * (M - alpha) / (alpha * M);
  const Real s = rankine ? measure : measure / std::sqrt(2.0);
  const Mat3 rate = rankine ? Mat3(Vec3(s, 0, 0).asDiagonal()) : Mat3(Vec3(s, -s, 0).asDiagonal());

  scene.solver.time_step = 1 / static_cast<Real>(steps);
  Model model = LatticeModel().add_box(Vec3::Constant(0.5), Vec3i(4, 4, 4), 0.5).model;
  model.velocity_gradient[0] = rate;
  for (std::size_t p = 0; p < model.X.size(); ++p) model.velocity[p] = rate * model.X[p];
  Trial trial(scene, model);
  trial->set_node_rule([rate](const Vec3& x, Real, Real, const Vec3&) { return Vec3(rate * x); });

  const Real volume = 0.125 * static_cast<Real>(model.X.size());
  const Real energy = tau_c * tau_c / (2 * alpha);
  DrivenResult out;
  Real before = 0;
  for (Index n = 0; n < steps; ++n) {
    const FrameReport report = trial.advance(1 / static_cast<Real>(steps));
    if (report.status != Status::ok) break;
    const Real work = report.dissipated_energy / volume;
    out.least_work = std::min(out.least_work, (work - before) / energy);
    before = work;
  }
  const Matter now = trial.matter();
  for (std::size_t p = 0; p < now.tau.size(); ++p) {
    const Vec3 tau = symmetric_eigen(now.tau[p]).value;
    const Vec3 deviator = tau - Vec3::Constant(tau.mean());
    const Real size = rankine ? tau.maxCoeff() : deviator.norm();
    out.stress = std::max(out.stress, std::abs(size - 0.5 * tau_c) / tau_c);
    out.excess = std::max(out.excess, (size - now.tau_c[p]) / tau_c);
  }
  out.dissipation = std::abs(before / energy - 0.75);
  out.cost = trial.cost();
  return out;
}

}  // namespace rend
