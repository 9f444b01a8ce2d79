// Runs of the manufactured wave.
#include "bench/problems/manufactured_wave.h"

#include "bench/problems/kuhn_model.h"
#include "bench/problems/lattice_model.h"

#include <algorithm>
#include <limits>

namespace rend {

namespace {

constexpr int kFrames = 5;

bool inside(const Vec3& X, bool thin) {
  for (int a = 0; a < (thin ? 1 : 3); ++a)
    if (!(X[a] > 0 && X[a] < 1)) return false;
  return true;
}

struct WaveProblem {
  SceneDesc scene = plain_scene();
  Model model;
  ManufacturedWave wave;
  Real frame = 0, steps = 0, dt = 0;  // duration and steps of a frame

  WaveProblem(const SolverDesc& solver, const WaveRun& run) : wave(material()) {
    const Real dx = 1.0 / run.cells, spacing = dx / run.per_axis;
    scene.grid.dx = dx;
    scene.solver = solver;
    wave.amplitude = run.amplitude;
    if (run.thin) wave.k[1] = wave.k[2] = 0;

    // Matter goes on for two cells beyond the cube, so that every node inside has its neighbours.
    const int margin = 2, count = (run.cells + 2 * margin) * run.per_axis;
    const Real low = -margin * dx;
    if (run.mesh) {
      scene.bodies.emplace_back().force = ForceKind::mesh;
      model = run.thin ? kuhn_box(Vec3(low, 0, 0), Vec3i(count, 1, 1), spacing)
                       : kuhn_box(Vec3(low, low, low), Vec3i(count, count, count), spacing);
    } else {
      const Vec3 corner =
          run.thin ? Vec3(low, -0.5 * spacing, -0.5 * spacing) : Vec3(low, low, low);
      const Vec3i counts = run.thin ? Vec3i(count, 1, 1) : Vec3i(count, count, count);
      model = LatticeModel().add_box(corner, counts, spacing).model;
    }
    frame = run.duration / wave.c / kFrames;
    steps = std::ceil(frame / (run.courant * dx / wave.speed()) * (1 - 1e-12));
    dt = frame / steps;
    scene.solver.time_step = dt;
    for (std::size_t p = 0; p < model.X.size(); ++p)
      model.velocity[p] = wave.velocity(model.X[p], run.half_step ? -0.5 * dt : 0);
  }

  const MaterialDesc& material() {
    scene.materials[0].youngs_modulus = 1;
    return scene.materials[0];
  }
};

}  // namespace

WaveErrors run_wave(const SolverDesc& solver, const WaveRun& run) {
  WaveProblem problem(solver, run);
  const Model& model = problem.model;
  const ManufacturedWave& wave = problem.wave;
  std::vector<std::size_t> watched;
  for (std::size_t p = 0; p < model.X.size(); ++p)
    if (inside(model.X[p], run.thin)) watched.push_back(p);
  Trial trial(problem.scene, model);
  trial->set_node_rule(wave.rule(run.thin));
  WaveErrors errors;
  Real most_u = 0, most_v = 0, most_tau = 0;
  for (int f = 1; f <= kFrames; ++f) {
    const FrameReport report = trial.advance(problem.frame);
    errors.cost = trial.cost();
    if (report.status != Status::ok) {
      errors.u = errors.v = errors.tau = std::numeric_limits<Real>::infinity();
      return errors;
    }
    const Real t = f * problem.frame;
    const Matter now = trial.matter();
    Real u2 = 0, v2 = 0, tau2 = 0, u_exact = 0, v_exact = 0, tau_exact = 0;
    for (std::size_t p : watched) {
      const Vec3& X = model.X[p];
      const Vec3 u = wave.displacement(X, t), v = wave.velocity(X, t - 0.5 * problem.dt);
      const Mat3 tau = wave.stress(X, t).asDiagonal();
      u2 += (now.x[p] - X - u).squaredNorm();
      v2 += (now.v[p] - v).squaredNorm();
      tau2 += (now.tau[p] - tau).squaredNorm();
      u_exact += u.squaredNorm();
      v_exact += v.squaredNorm();
      tau_exact += tau.squaredNorm();
    }
    errors.u = std::max(errors.u, u2);
    errors.v = std::max(errors.v, v2);
    errors.tau = std::max(errors.tau, tau2);
    most_u = std::max(most_u, u_exact);
    most_v = std::max(most_v, v_exact);
    most_tau = std::max(most_tau, tau_exact);
    if (f < kFrames) continue;
    for (std::size_t p : watched) errors.last.push_back(now.x[p][0] - model.X[p][0]);
  }
  errors.u = std::sqrt(errors.u / most_u);
  errors.v = std::sqrt(errors.v / most_v);
  errors.tau = std::sqrt(errors.tau / most_tau);
  return errors;
}

RunCost time_wave(const SolverDesc& solver, const WaveRun& run, Index steps) {
  const WaveProblem problem(solver, run);
  Trial trial(problem.scene, problem.model);
  if (run.thin) trial->set_node_rule(only_along(Vec3::UnitX()));
  trial.advance(static_cast<Real>(steps) * problem.dt);
  return trial.cost();
}

}  // namespace rend
