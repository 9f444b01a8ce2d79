// The step of explicit MPM, and the frame around it.
#include "engine/mpm/reference_solver.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/small_matrix.h"
#include "engine/mpm/node_loads.h"
#include "engine/mpm/scene_hash.h"
#include "engine/mpm/xpic_series.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

namespace rend {

namespace {

constexpr Index kGrain = 1024;
constexpr Real kMostSteps = 1e7;  // in one advance; more means that the state has blown up

}  // namespace

Mat3 step_exponent(const Mat3& H) {
  const Mat3 W = 0.5 * (H - H.transpose());
  return H - 0.5 * W * W;
}

ReferenceSolver::StepSums& ReferenceSolver::StepSums::operator+=(const StepSums& other) {
  motion += other.motion;
  dissipation += other.dissipation;
  clamped += other.clamped;
  if (fault.status == Status::ok) fault = other.fault;
  return *this;
}

ReferenceSolver::ReferenceSolver(const SceneDesc& scene, const Model& model)
    : scene_(scene),
      dx_(scene.grid.dx),
      transfer_(make_grid_transfer(scene.solver)),
      materials_(scene.materials.begin(), scene.materials.end()),
      strength_(model.strength),
      scene_hash_(hash_scene(scene, model)),
      mesh_(scene, model, materials_),
      gravity_(scene.gravity) {
  const std::size_t count = model.X.size();
  particles_.x = model.X;
  particles_.v = model.velocity;
  particles_.F.assign(count, Mat3::Identity());
  particles_.tau.assign(count, Mat3::Zero());
  particles_.volume = model.volume;
  particles_.material = model.material;
  particles_.yielded.assign(count, 0);
  particles_.tau_c.resize(count);
  particles_.mass.resize(count);
  if (transfer_.carried.affine) particles_.C.assign(count, Mat3::Zero());
  if (transfer_.carried.multilinear) particles_.modes.assign(count, VelocityModes::Zero());
  for (std::size_t i = 0; i < count; ++i) {
    const Index p = static_cast<Index>(i);
    particles_.tau_c[i] = tau_c0(p);
    particles_.mass[i] = model.volume[i] * materials_[model.material[i]].desc.density;
    if (transfer_.carried.affine && model.body[i] < model.velocity_gradient.size())
      particles_.C[i] = model.velocity_gradient[model.body[i]];
    if (!inside_domain(particles_.x[i]))
      throw Error("/bodies",
                  fmt::format("particle {} at ({}, {}, {}) m is outside +-2^20 cells of {} m", i,
                              particles_.x[i][0], particles_.x[i][1], particles_.x[i][2], dx_));
  }
  if (!mesh_.empty()) particles_.force.assign(count, Vec3::Zero());
  first_node_.resize(count);
  measure_motion();
  fill_report(report_);
  balance_.open(report_);
  balance_.settle(report_);
}

// ---- one step
// -------------------------------------------------------------------------------------------------

ReferenceSolver::StepSums ReferenceSolver::step(Real dt) {
  bin_particles();
  particles_to_grid();
  update_grid(dt);
  if (scene_.solver.transfer == Transfer::xpic)
    add_xpic_series(scene_.solver.xpic_order, transfer_, particles_, dx_, grid_);
  StepSums sums = grid_to_particles(dt);
  evaluate_mesh(sums);
  return sums;
}

void ReferenceSolver::evaluate_mesh(StepSums& sums) {
  if (mesh_.empty() || sums.fault.status != Status::ok) return;
  const MeshForce::Sums mesh = mesh_.evaluate(materials_, particles_.x, particles_.force);
  sums.dissipation += mesh.dissipation;
  sums.clamped += mesh.clamped;
  sums.motion.element_rate = std::max(sums.motion.element_rate, mesh.rate);
}

void ReferenceSolver::bin_particles() {
  parallel_for(particles_.count(), kGrain, [&](Index p) {
    const auto i = static_cast<std::size_t>(p);
    first_node_[i] = transfer_.first_node(particles_.x[i], dx_);
  });
  grid_.rebuild(first_node_);
}

void ReferenceSolver::particles_to_grid() {
  grid_.clear();
  for (int c = 0; c < 8; ++c) {
    const std::vector<Index>& blocks = grid_.color(c);
    parallel_for(static_cast<Index>(blocks.size()), 1, [&](Index n) {
      const auto& block =
          grid_.particle_blocks()[static_cast<std::size_t>(blocks[static_cast<std::size_t>(n)])];
      transfer_.scatter(block, particles_, dx_, grid_);
    });
  }
}

void ReferenceSolver::update_grid(Real dt) {
  const Index blocks = static_cast<Index>(grid_.grid_blocks().size());
  NodeLoads loads(scene_.colliders, pull_, time_ + dt, node_rule_);
  if (loads.pulls())
    balance_.nodes.external += loads.set_pulled(
        ordered_sum(blocks, 8, PulledMatter(),
                    [&](Index b) {
                      PulledMatter sum;
                      for (int n = 0; n < BlockGrid::kNodes; ++n) {
                        const GridNode& node = grid_.nodes(b)[n];
                        if (node.mass > 0)
                          sum += loads.pulled(
                              grid_.position(b, n, dx_), node.mass,
                              (node.momentum + dt * node.force) / node.mass + dt * gravity_);
                      }
                      return sum;
                    }),
        dt, pull_);
  const Real block_radius = 0.5 * std::sqrt(3.0) * (BlockGrid::kEdge - 1) * dx_;

  balance_.nodes += ordered_sum(blocks, 8, NodeWork(), [&](Index b) {
    const GridNode* node = grid_.nodes(b);
    NodeVelocity* out = grid_.velocities(b);
    const Vec3 centre =
        0.5 * (grid_.position(b, 0, dx_) + grid_.position(b, BlockGrid::kNodes - 1, dx_));
    const NodeLoads::Near near = loads.near(centre, block_radius);

    NodeWork work;
    for (int n = 0; n < BlockGrid::kNodes; ++n) {
      if (!(node[n].mass > 0)) {
        out[n] = {};
        continue;
      }
      const Vec3 v_old = node[n].momentum / node[n].mass;
      Vec3 v = v_old + dt * (node[n].force / node[n].mass + gravity_);
      bool held = false;
      if (!near.none()) {
        const Vec3 x = grid_.position(b, n, dx_);
        v = loads.apply(near, x, node[n].mass, dt, v, work);
        held = loads.meets(near, x);
      }
      out[n] = {v, v - v_old, held};
    }
    return work;
  });
  motion_.collider_speed = loads.collider_speed();
}

ReferenceSolver::StepSums ReferenceSolver::grid_to_particles(Real dt) {
  return ordered_sum(
      static_cast<Index>(grid_.particle_blocks().size()), 1, StepSums(), [&](Index b) {
        const auto& block = grid_.particle_blocks()[static_cast<std::size_t>(b)];
        std::vector<GridSample> sample(static_cast<std::size_t>(block.end - block.begin));
        transfer_.gather(block, grid_, dx_, scene_.solver, particles_, sample.data());
        StepSums sums;
        for (Index n = block.begin; n < block.end; ++n)
          move_particle(grid_.order()[static_cast<std::size_t>(n)],
                        sample[static_cast<std::size_t>(n - block.begin)], dt, sums);
        return sums;
      });
}

void ReferenceSolver::move_particle(Index p, const GridSample& sample, Real dt, StepSums& sums) {
  const auto i = static_cast<std::size_t>(p);
  const Vec3 displacement = dt * sample.pic;
  particles_.x[i] += displacement;
  const Mat3 H = dt * sample.gradient;
  if (!mesh_.carries(p))
    particles_.F[i] = scene_.solver.deformation_update == DeformationUpdate::exponential
                          ? Mat3(matrix_exponential(step_exponent(H)) * particles_.F[i])
                          : Mat3(particles_.F[i] + H * particles_.F[i]);
  respond(p, sums);
  sums.motion.gradient = std::max(sums.motion.gradient, sample.gradient.norm());
  sums.motion.speed = std::max(sums.motion.speed, sample.pic.norm());
  watch(p, displacement, dt, sums);
}

void ReferenceSolver::respond(Index p, StepSums& sums) {
  const auto i = static_cast<std::size_t>(p);
  Real speed = particles_.v[i].norm();
  if (transfer_.carried.affine) speed += std::sqrt(3.0) * dx_ * particles_.C[i].norm();
  if (transfer_.carried.multilinear) {
    speed += std::sqrt(3.0) * dx_ * dx_ * particles_.modes[i].leftCols<3>().norm() +
             dx_ * dx_ * dx_ * particles_.modes[i].col(3).norm();
  }
  sums.motion.speed = std::max(sums.motion.speed, speed);
  if (mesh_.carries(p)) return;
  const SolverMaterial& material = materials_[particles_.material[i]];
  const PointUpdate update =
      material.respond(material.constants, particles_.F[i], particles_.tau_c[i], tau_c0(p));
  particles_.tau[i] = update.tau;
  particles_.yielded[i] |= update.yielded;
  sums.dissipation += particles_.volume[i] * update.dissipation;
  sums.clamped += update.clamped;
  sums.motion.stiffness =
      std::max(sums.motion.stiffness,
               wave_stiffness(material.lame.mu, material.lame.lambda, update.least_stress) /
                   material.desc.density);
}

void ReferenceSolver::watch(Index p, const Vec3& displacement, Real dt, StepSums& sums) const {
  if (sums.fault.status != Status::ok) return;
  const auto i = static_cast<std::size_t>(p);
  const Real farthest = particles_.x[i].cwiseAbs().maxCoeff();
  const Real moved = displacement.cwiseAbs().maxCoeff();
  const bool finite = std::isfinite(displacement.sum()) && std::isfinite(particles_.v[i].sum()) &&
                      std::isfinite(particles_.F[i].sum()) &&
                      std::isfinite(particles_.tau[i].sum());
  if (!finite)
    sums.fault = {Status::not_finite, p};
  else if (moved > dx_)
    sums.fault = {Status::too_fast, p, displacement.norm() / dt};
  else if (farthest >= dx_ * (BlockGrid::kLimit - 8))
    sums.fault = {Status::left_domain, p, farthest};
}

// ---- one frame
// ------------------------------------------------------------------------------------------------

FrameReport ReferenceSolver::advance(Real duration, const BetweenSteps& between) {
  const auto begin = std::chrono::steady_clock::now();
  FrameReport report;
  Fault fault = first_bad_particle();
  if (fault.status == Status::ok) remember();
  const Real start = time_;
  const Real end = start + duration;
  report.dt_min = report.dt_max = 0;
  bool complete = true;
  while (fault.status == Status::ok && time_ < end) {
    const Real dt = choose_time_step(scene_.solver, dx_, motion_, end - time_);
    if (!(duration / dt < kMostSteps)) {
      fault = {Status::too_fast, -1, motion_.speed, true};
      break;
    }
    StepSums sums;
    try {
      sums = step(dt);
    } catch (const std::bad_alloc&) {
      fault = {Status::out_of_memory};
      break;
    }
    fault = sums.fault;
    if (fault.status != Status::ok) break;
    const Real collider_speed = motion_.collider_speed;
    motion_ = sums.motion;
    motion_.collider_speed = collider_speed;
    if (report.substeps == 0) balance_.change_step(report_, dt);
    balance_.last_step = dt;
    balance_.dissipated += sums.dissipation;
    report.clamped += sums.clamped;
    time_ = dt < end - time_ ? time_ + dt : end;
    report.dt_min = report.substeps == 0 ? dt : std::min(report.dt_min, dt);
    report.dt_max = std::max(report.dt_max, dt);
    ++report.substeps;
    if (between && !between()) {
      complete = time_ >= end;
      break;
    }
  }
  report.status = fault.status;
  report.culprit = fault.particle;
  const Real failed_at = time_;
  if (fault.status != Status::ok)
    restore();
  else if (complete)
    ++frame_;
  report.reason = rend::describe(fault, failed_at, report.substeps + 1);
  fill_report(report);
  report.sim_seconds =
      std::chrono::duration<Real>(std::chrono::steady_clock::now() - begin).count();
  report_ = report;
  return report;
}

Real ReferenceSolver::stable_time_step() const {
  return choose_time_step(scene_.solver, dx_, motion_, 1e30);
}

// Extremes and stress of the current state, as a step of length 0 would leave them.
void ReferenceSolver::measure_motion() {
  const StepSums sums = ordered_sum(particles_.count(), kGrain, StepSums(), [&](Index p) {
    StepSums one;
    respond(p, one);
    if (transfer_.carried.affine)
      one.motion.gradient = particles_.C[static_cast<std::size_t>(p)].norm();
    return one;
  });
  StepSums all = sums;
  evaluate_mesh(all);
  motion_ = all.motion;
  balance_.dissipated += all.dissipation;
  for (const PosedCollider& c : pose_colliders(scene_.colliders, time_))
    motion_.collider_speed = std::max(motion_.collider_speed, fastest_point(c));
}

Real ReferenceSolver::tau_c0(Index p) const {
  const auto i = static_cast<std::size_t>(p);
  return materials_[particles_.material[i]].tau_c0 *
         (strength_.empty() ? 1.0 : static_cast<Real>(strength_[i]));
}

bool ReferenceSolver::is_damaged(Index p) const {
  const auto i = static_cast<std::size_t>(p);
  return materials_[particles_.material[i]].desc.damage.type != DamageType::off &&
         !(particles_.tau_c[i] > 0);
}

bool ReferenceSolver::inside_domain(const Vec3& x) const {
  return x.allFinite() && x.cwiseAbs().maxCoeff() < dx_ * (BlockGrid::kLimit - 8);
}

Fault ReferenceSolver::first_bad_particle() const {
  for (Index p = 0; p < particles_.count(); ++p) {
    const auto i = static_cast<std::size_t>(p);
    const bool finite = particles_.x[i].allFinite() && particles_.v[i].allFinite() &&
                        particles_.F[i].allFinite() &&
                        (!transfer_.carried.affine || particles_.C[i].allFinite()) &&
                        (!transfer_.carried.multilinear || particles_.modes[i].allFinite());
    if (!finite) return {Status::not_finite, p};
  }
  return {};
}

void ReferenceSolver::remember() { good_ = {particles_, mesh_.state(), time_, balance_, motion_}; }

void ReferenceSolver::restore() {
  if (good_.particles.count() != particles_.count()) return;
  particles_ = good_.particles;
  mesh_.set_state(good_.mesh);
  time_ = good_.time;
  balance_ = good_.balance;
  motion_ = good_.motion;
}

void ReferenceSolver::set_material(std::size_t index, const MaterialDesc& material) {
  const SolverMaterial old = materials_.at(index);
  FrameReport before, after;
  measure_energy(before);
  materials_[index] = SolverMaterial(material);
  const SolverMaterial& now = materials_[index];
  for (Index p = 0; p < particles_.count(); ++p) {
    const auto i = static_cast<std::size_t>(p);
    if (particles_.material[i] != index) continue;
    particles_.mass[i] = particles_.volume[i] * material.density;
    if (particles_.tau_c[i] > 0 || old.tau_c0 == 0)
      particles_.tau_c[i] =
          old.tau_c0 > 0 ? particles_.tau_c[i] * (now.tau_c0 / old.tau_c0) : tau_c0(p);
  }
  mesh_.rescale_thresholds(materials_, index, old.tau_c0);
  measure_motion();
  measure_energy(after);
  balance_.rebase(before, after);
  report_.power = after.power;
}

void ReferenceSolver::set_gravity(const Vec3& gravity) {
  FrameReport before, after;
  measure_energy(before);
  gravity_ = gravity;
  measure_energy(after);
  balance_.rebase(before, after);
  report_.power = after.power;
}

std::string ReferenceSolver::describe() const {
  const char* transfers[] = {"pic", "flip", "apic", "rpic", "polypic", "xpic"};
  return fmt::format("reference solver, double, {}, {} kernel, {} force",
                     transfers[static_cast<int>(scene_.solver.transfer)],
                     scene_.solver.kernel == Kernel::quadratic ? "quadratic" : "cubic",
                     scene_.solver.force_form == ForceForm::mls ? "mls" : "gradient");
}

}  // namespace rend
