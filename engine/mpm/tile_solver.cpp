// The frame of the tile solver: steps between two complete states.
#include "engine/mpm/tile_solver.h"

#include "engine/core/error.h"
#include "engine/core/stopwatch.h"
#include "engine/mpm/node_loads.h"
#include "engine/mpm/scene_hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

namespace rend {

namespace {

// A particle may be this far beyond its block, in cells; a whole cell is what the node tile has
// room for.
constexpr float kMargin = 0.999f;
// Islands are looked for again after this many steps, or when something has gone this far, or when
// they may have strayed this far from free fall or other matter from its place [cells].
constexpr Real kStepsOfLeg = 40;
constexpr Real kFarthest = 2;
constexpr Real kLeastStray = 0.05;
constexpr Real kLeastReach = 0.1;
// What may speed up before a leg ends is looked at as if it were this much faster.
constexpr Real kFaster = 2;
constexpr Real kMostSteps = 1e7;  // in one advance; more means that the state has blown up

}  // namespace

std::string TileSolver::obstacle(const SceneDesc& scene) {
  const SolverDesc& solver = scene.solver;
  if (solver.precision != Precision::float32) return "the scene asks for double precision";
  if (solver.transfer == Transfer::polypic) return "PolyPIC is in the reference solver only";
  if (solver.transfer == Transfer::xpic) return "XPIC is in the reference solver only";
  if (solver.kernel != Kernel::quadratic) return "the cubic kernel is in the reference solver only";
  if (solver.force_form != ForceForm::mls)
    return "the gradient force is in the reference solver only";
  if (solver.deformation_update != DeformationUpdate::exponential)
    return "the linear deformation update is in the reference solver only";
  if (!tile_kernels()) return "this CPU (or REND_SIMD) has no instruction set with vector kernels";
  return "";
}

Real TileSolver::Material::stiffness(const RunExtremes& extremes) const {
  if (constants.on_mesh) return 0;
  const Lame lame = lame_parameters(desc.youngs_modulus, desc.poisson_ratio);
  return wave_stiffness(lame.mu, lame.lambda, extremes.least_stress) / desc.density;
}

TileSolver::TileSolver(const SceneDesc& scene, const Model& model, const TileKernels* kernels)
    : scene_(scene),
      dx_(scene.grid.dx),
      density_(scene.materials.at(0).density),
      kernels_(kernels ? kernels : tile_kernels()),
      strength_(model.strength),
      scene_hash_(hash_scene(scene, model)),
      grid_(scene.solver.transfer == Transfer::flip),
      mesh_(scene, model, laws_of(scene.materials)),
      gravity_(scene.gravity) {
  for (const MaterialDesc& material : scene.materials)
    materials_.push_back({material, constants_of(material)});
  add_mesh_materials();
  place(model);
  measure_motion();
  fill_report(report_);
  balance_.open(report_);
  balance_.settle(report_);
}

MaterialConstants TileSolver::constants_of(const MaterialDesc& material) const {
  const LawConstants<Real> exact = law_constants(material);
  MaterialConstants out;
  out.law.mu2 = static_cast<float>(exact.mu2);
  out.law.inverse_mu2 = static_cast<float>(exact.inverse_mu2);
  out.law.lambda = static_cast<float>(exact.lambda);
  for (int i = 0; i < kMaxSurfaceConstants; ++i)
    out.law.surface[i] = static_cast<float>(exact.surface[i]);
  out.law.damage_threshold = static_cast<float>(exact.damage_threshold);
  out.law.damage_mu2 = static_cast<float>(exact.damage_mu2);
  out.law.damage_friction = static_cast<float>(exact.damage_friction);
  out.density = static_cast<float>(material.density / density_);
  out.tau_c0 = static_cast<float>(initial_threshold(material.yield_surface));
  out.response = 3 * material.yield_surface.type + static_cast<int>(material.damage.type);
  return out;
}

TileLayout TileSolver::needed_layout(TileLayout layout,
                                     const std::vector<Material>& materials) const {
  const auto any_material = [&](auto&& test) {
    return std::any_of(materials.begin(), materials.end(),
                       [&](const Material& m) { return !m.constants.on_mesh && test(m.desc); });
  };
  if (layout.tau_c < 0 &&
      any_material([](const MaterialDesc& m) { return m.yield_surface.type != 0; }))
    layout.tau_c = layout.groups++;
  if (layout.tau_c0 < 0 && !strength_.empty() &&
      any_material([](const MaterialDesc& m) { return m.damage.type != DamageType::off; }))
    layout.tau_c0 = layout.groups++;
  if (layout.velocity < 0 && is_flip()) {
    layout.velocity = layout.groups;
    layout.groups += 3;
  }
  return layout;
}

void TileSolver::place(const Model& model) {
  const TileLayout layout = needed_layout(store_.layout(), materials_);

  std::vector<TileStore::Arrival> arrivals(model.X.size());
  for (std::size_t i = 0; i < model.X.size(); ++i) {
    const Vec3 cells = model.X[i] / dx_;
    if (!cells.allFinite() || !(cells.cwiseAbs().maxCoeff() < 4.0 * (TileStore::kLimit - 2)))
      throw Error("/bodies",
                  fmt::format("particle {} at ({}, {}, {}) m is outside +-2^20 cells of {} m", i,
                              model.X[i][0], model.X[i][1], model.X[i][2], dx_));
    TileStore::Arrival& a = arrivals[i];
    a.id = static_cast<Index>(i);
    a.material = kind_of(model.material[i], a.id);
    for (int c = 0; c < 3; ++c) {
      a.block[c] = static_cast<int>(std::floor((cells[c] + 0.5) / 4));
      a.x[c] = static_cast<float>(cells[c] - 4.0 * a.block[c]);
    }
  }
  const Real cell_volume = dx_ * dx_ * dx_;
  store_.place(layout, std::move(arrivals), [&](float* lane, Index id) {
    const auto i = static_cast<std::size_t>(id);
    for (int g = 0; g < 6; ++g) lane[(TileLayout::kStrain + g) * kLanes] = 0;
    lane[TileLayout::kVolume * kLanes] = static_cast<float>(model.volume[i] / cell_volume);
    const float threshold = static_cast<float>(tau_c0(model.material[i], id));
    if (layout.tau_c >= 0) lane[layout.tau_c * kLanes] = threshold;
    if (layout.tau_c0 >= 0) lane[layout.tau_c0 * kLanes] = threshold;
    for (int a = 0; a < 3 && layout.velocity >= 0; ++a)
      lane[(layout.velocity + a) * kLanes] = static_cast<float>(model.velocity[i][a] / dx_);
    if (mesh_.carries(id)) set_low_position(model.X[i] / dx_, lane);
  });

  make_room_for_motion();
  std::fill(motion(), motion() + std::size_t(store_.tile_count()) * kMotionFloats, 0.0f);
  for (std::size_t slot = 0; slot < store_.ids().size(); ++slot) {
    if (store_.ids()[slot] < 0) continue;
    const auto i = static_cast<std::size_t>(store_.ids()[slot]);
    float* lane = motion() + slot / kLanes * kMotionFloats + slot % kLanes;
    for (int a = 0; a < 3; ++a) lane[a * kLanes] = static_cast<float>(model.velocity[i][a] / dx_);
    if (model.body[i] >= model.velocity_gradient.size()) continue;
    const Mat3& L = model.velocity_gradient[model.body[i]];
    if (keeps_affine_velocity(scene_.solver))
      for (int a = 0; a < 9; ++a) lane[(3 + a) * kLanes] = static_cast<float>(L(a / 3, a % 3));
  }
  update_topology();
}

void TileSolver::make_room_for_motion() {
  spare_.reserve(std::size_t(store_.tile_count()) *
                 std::max(kMotionFloats, store_.layout().floats()));
}

void TileSolver::update_topology() {
  grid_.relate(store_.regular_blocks());
  grid_.rebuild(store_.regular_blocks());
  topology_fits_ = true;
}

// ---- islands

void TileSolver::begin_leg(Real remaining) {
  const Stopwatch watch(times_.legs);
  leg_ = {};
  ++legs_;
  leg_.bounds.gravity = gravity_ / dx_;
  const Real fastest = (motion_.speed + motion_.collider_speed) / dx_;
  Real time = kStepsOfLeg * choose_time_step(scene_.solver, dx_, motion_, remaining);
  if (fastest > 0) time = std::min(time, kFarthest / fastest);
  if (gravity_.norm() > 0) time = std::min(time, std::sqrt(kFarthest / leg_.bounds.gravity.norm()));
  leg_.bounds.time = remaining / std::ceil(remaining / time);  // legs of one length
  leg_.bounds.stray = kLeastStray;
  leg_.bounds.reach = std::max(kLeastReach, leg_.bounds.time * motion_.collider_speed / dx_);

  NodeLoads loads(scene_.colliders, pull_, time_, node_rule_);
  loads.assume_pulled();
  const Real beyond = 1.5 * std::sqrt(3.0) + leg_.bounds.reach;
  // Islands have no second part of nodes; single particles need none.
  const std::vector<std::int32_t> island = find_islands(
      store_, motion(), leg_.bounds, is_flip() ? 1 : store_.particle_count(),
      [&](const TileRun& run) { return !on_mesh(run); },
      [&](const Vec3& centre, Real radius) {
        return loads.none() || loads.near(dx_ * centre, dx_ * (radius + beyond)).none();
      });
  std::vector<std::uint8_t> parked(island.size());
  std::transform(island.begin(), island.end(), parked.begin(), [](auto n) { return n >= 0; });
  if (std::count(parked.begin(), parked.end(), 0) < static_cast<Index>(parked.size())) {
    store_.park(parked);
    std::vector<std::int32_t> of_parked;
    std::copy_if(island.begin(), island.end(), std::back_inserter(of_parked),
                 [](auto n) { return n >= 0; });
    islands_.pack(store_, motion(), of_parked, leg_.bounds);
    topology_fits_ = false;
  }
  if (!topology_fits_) update_topology();
}

bool TileSolver::leg_ends(Real dt, Real next) const {
  if (islands_.empty()) return false;
  return leg_.time + dt + next > leg_.bounds.time * (1 + 1e-9) ||
         leg_.travel + kFaster * dt * leg_.fastest > leg_.bounds.reach ||
         leg_.strayed + kFaster * dt * leg_.straying > leg_.bounds.stray;
}

void TileSolver::end_leg() {
  if (islands_.empty()) return;
  const Stopwatch watch(times_.legs);
  islands_.unpack(store_, motion());
  islands_.clear();
  excess_ = std::max(excess_, store_.release());
  if (!(excess_ < kMargin)) {
    AlignedFloats tiles;
    store_.rebin(tiles, &spare_);
    excess_ = 0;
    ++times_.rebins;
  }
  topology_fits_ = false;
}

// ---- one frame

// Steps until the frame ends or islands may meet others; begins and ends with a complete
// state.
Fault TileSolver::run_leg(Real begin, Real end, const BetweenSteps& between, FrameReport& report) {
  const auto too_many = [&](Real dt) { return !((end - begin) / dt < kMostSteps); };
  begin_leg(end - time_);
  common_velocity_ = (report_.momentum / (report_.mass * dx_)).cast<float>();
  if (!common_velocity_.allFinite()) common_velocity_.setZero();
  Real dt = choose_time_step(scene_.solver, dx_, motion_, end - time_);
  if (too_many(dt)) return {Status::too_fast, -1, motion_.speed, true};
  every_particle(Pass::scatter, step_constants(Pass::scatter, 0, dt), dt);
  for (bool last = false; !last;) {
    const Real fastest = grid_pass(dt);
    if (!std::isfinite(fastest)) {
      // Particles that gather from a bad node are bad too, which tells where it was. Too fast a
      // node is no fault yet: next to hard-pressed matter, nodes with next to no mass may be, and
      // no particle follows them. The pass tells how far particles really went.
      make_room_for_motion();
      every_particle(Pass::gather, step_constants(Pass::gather, dt, 0), 0);
      return {Status::not_finite};
    }
    const float reach = static_cast<float>(dt * fastest);
    const bool rebin = !(excess_ + reach < kMargin);
    if (rebin) {
      const Stopwatch watch(times_.rebin);
      store_.rebin(spare_);
      grid_.relate(store_.regular_blocks());
      ++times_.rebins;
    }
    const Real after = dt < end - time_ ? time_ + dt : end;
    stopped_ = stopped_ || (after < end && between && !between());
    last = after >= end || stopped_;
    Real next = 0;
    if (!last) {
      next = choose_time_step(scene_.solver, dx_, motion_, end - after);
      if (too_many(next)) return {Status::too_fast, -1, motion_.speed, true};
    }
    last = last || leg_ends(dt, next);
    // What is not finite goes on, for the pass to find where.
    if (!islands_.empty() && dt * (motion_.speed + dt * gravity_.norm()) >= dx_)
      return {Status::too_fast, -1, motion_.speed};
    if (last || !mesh_.empty()) make_room_for_motion();
    const Pass pass = last ? Pass::gather : Pass::fused;
    const StepSums sums = every_particle(pass, step_constants(pass, dt, next), next);
    if (rebin) {
      const Stopwatch watch(times_.rebin);
      grid_.rebuild(store_.regular_blocks());
    }
    if (!sums.finite || !(sums.excess < 1))
      return {sums.finite ? Status::too_fast : Status::not_finite, -1, sums.motion.speed};
    excess_ = std::max(sums.excess, 0.0f);
    const Real collider_speed = motion_.collider_speed;
    leg_.fastest = std::max(sums.fastest, collider_speed / dx_);
    leg_.travel += dt * leg_.fastest;
    leg_.straying = sums.strayed;
    leg_.strayed += dt * leg_.straying;
    leg_.time += dt;
    motion_ = sums.motion;
    motion_.collider_speed = collider_speed;
    if (report.substeps == 0) balance_.change_step(report_, dt);
    balance_.last_step = dt;
    balance_.dissipated += sums.dissipation * dx_ * dx_ * dx_;
    report.clamped += sums.clamped;
    time_ = after;
    report.dt_min = report.substeps == 0 ? dt : std::min(report.dt_min, dt);
    report.dt_max = std::max(report.dt_max, dt);
    ++report.substeps;
    ++times_.steps;
    dt = next;
  }
  end_leg();
  return {};
}

FrameReport TileSolver::advance(Real duration, const BetweenSteps& between) {
  const auto clock = std::chrono::steady_clock::now();
  FrameReport report;
  report.dt_min = report.dt_max = 0;
  Fault fault;
  good_ = {};  // before the copy, which would not fit beside it
  good_ = state();
  stopped_ = false;
  const Real begin = time_, end = time_ + duration;
  try {
    while (fault.status == Status::ok && time_ < end && !stopped_)
      fault = run_leg(begin, end, between, report);
  } catch (const std::bad_alloc&) {
    fault = {Status::out_of_memory};
  }
  const Real stopped_at = time_;
  if (fault.status == Status::ok) {
    if (!stopped_) ++frame_;
    fill_report(report);
    if (!std::isfinite(report.kinetic_energy + report.elastic_energy + report.gravity_energy))
      fault = {Status::not_finite};
    else
      fault = farthest_block();
    if (fault.status != Status::ok && !stopped_) --frame_;
  }
  if (fault.status != Status::ok) {
    // A leg that ended early has not made room for motion since particles were sorted anew.
    if (!islands_.empty() && fault.status != Status::out_of_memory) {
      make_room_for_motion();
      islands_.unpack(store_, motion());
    }
    const Index suspected = fault.particle < 0 && !fault.tiny_step ? suspect() : fault.particle;
    restore(good_);
    // A value that was bad before the frame has spread by now.
    const Index bad = first_bad_particle();
    fault.particle = bad >= 0 ? bad : suspected;
    if (bad >= 0) fault.status = Status::not_finite;
    fill_report(report);
  }
  good_ = {};
  report.status = fault.status;
  report.culprit = fault.particle;
  report.reason = rend::describe(fault, stopped_at, report.substeps + 1);
  report.sim_seconds =
      std::chrono::duration<Real>(std::chrono::steady_clock::now() - clock).count();
  report_ = report;
  return report;
}

}  // namespace rend
