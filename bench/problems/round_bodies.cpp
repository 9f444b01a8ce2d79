// Balls and discs.
#include "bench/problems/round_bodies.h"

#include "engine/material/law_constants.h"

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

bool keeps_affine_velocity(Transfer transfer) {
  return transfer == Transfer::apic || transfer == Transfer::rpic || transfer == Transfer::polypic;
}

RoundResult compare(const MotionBalance& before, const MotionBalance& after, Real elastic) {
  RoundResult out;
  out.kinetic = after.kinetic / before.kinetic;
  out.energy = (after.kinetic + elastic) / before.kinetic;
  out.spin = after.spin / before.spin - 1;
  return out;
}

}  // namespace

RoundBodies::RoundBodies(const SolverDesc& solver, Real dx, bool is_thin, Real courant, int axis)
    : scene(plain_scene()), thin(is_thin), per_axis(axis) {
  scene.grid.dx = dx;
  scene.solver = solver;
  scene.materials[0].youngs_modulus = 1000;
  const Lame lame = lame_parameters(1000, scene.materials[0].poisson_ratio);
  scene.solver.time_step = courant * dx / std::sqrt(lame.lambda + 2 * lame.mu);
}

void RoundBodies::add(const Vec3& centre, Real radius, const Vec3& velocity) {
  const Real spacing = scene.grid.dx / per_axis;
  const int count = 2 * static_cast<int>(std::ceil(radius / spacing));
  Vec3 low = centre - Vec3::Constant(0.5 * count * spacing);
  if (thin) low[2] = -0.5 * spacing;
  body.add_box(low, Vec3i(count, count, thin ? 1 : count), spacing, velocity, 0, 0,
               [&](const Vec3& x) { return (x - centre).head(thin ? 2 : 3).norm() < radius; });
}

Trial RoundBodies::trial() const {
  Trial out(scene, body.model);
  if (thin) out->set_node_rule(only_along(Vec3(1, 1, 0)));
  return out;
}

MotionBalance motion_balance(const RoundBodies& bodies, const Trial& trial) {
  const Matter now = trial.matter();
  const Real dx = bodies.scene.grid.dx;
  const Real inertia = (bodies.scene.solver.kernel == Kernel::cubic ? 1.0 / 3 : 0.25) * dx * dx;
  const Real mass = bodies.scene.materials[0].density * bodies.body.model.volume[0];
  const bool affine = keeps_affine_velocity(bodies.scene.solver.transfer);
  MotionBalance out;
  for (std::size_t p = 0; p < now.x.size(); ++p) {
    const Vec3 &x = now.x[p], &v = now.v[p];
    out.kinetic += 0.5 * mass * v.squaredNorm();
    out.momentum += mass * v;
    out.spin += mass * (x[0] * v[1] - x[1] * v[0]);
    if (!affine) continue;
    const Mat3& C = now.C[p];
    out.kinetic += 0.5 * mass * inertia * C.squaredNorm();
    out.spin += mass * inertia * (C(1, 0) - C(0, 1));
  }
  return out;
}

RoundResult turn(const SolverDesc& solver, Real revolutions, const RoundRun& run) {
  RoundBodies bodies(solver, 1.0 / run.cells, run.thin, run.courant, run.per_axis);
  bodies.add(Vec3::Zero(), 1, Vec3::Zero());
  bodies.body.spin(0, Vec3::Zero(), Vec3::UnitZ());
  Trial trial = bodies.trial();
  const MotionBalance before = motion_balance(bodies, trial);
  const FrameReport report = trial.advance(2 * kPi * revolutions);
  RoundResult out = compare(before, motion_balance(bodies, trial), report.elastic_energy);
  out.cost = trial.cost();
  return out;
}

RoundResult bounce(const SolverDesc& solver, const RoundRun& run) {
  RoundBodies bodies(solver, 0.4 / run.cells, run.thin, run.courant, run.per_axis);
  bodies.add(Vec3(-0.6, -0.15, 0), 0.4, Vec3(1, 0, 0));
  bodies.add(Vec3(0.6, 0.15, 0), 0.4, Vec3(-1, 0, 0));
  Trial trial = bodies.trial();
  const MotionBalance before = motion_balance(bodies, trial);
  MotionBalance after;
  RoundResult out;
  const int frames = 30;
  Real most = 0, squeezed = 0;
  for (int f = 0; f < frames; ++f) {
    const FrameReport report = trial.advance(0.9 / frames);
    if (report.status != Status::ok) break;
    after = motion_balance(bodies, trial);
    out = compare(before, after, report.elastic_energy);
    most = std::max(most, out.energy);
    squeezed = std::max(squeezed, report.elastic_energy / before.kinetic);
  }
  out.most = most;
  out.squeezed = squeezed;
  const Real half = 0.5 * bodies.scene.materials[0].density * bodies.body.model.volume[0] *
                    static_cast<Real>(bodies.body.model.X.size());
  out.momentum = (after.momentum - before.momentum).norm() / half;
  out.cost = trial.cost();
  return out;
}

}  // namespace rend
