// The step of the tile solver, and the frame around it.
#include "engine/mpm/tile_solver.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mpm/node_loads.h"
#include "engine/mpm/scene_hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <new>

namespace rend {

namespace {

// A particle may be this far beyond its block, in cells; a whole cell is what the node tile has
// room for.
constexpr float kMargin = 0.999f;
constexpr Real kMostSteps = 1e7;  // in one advance; more means that the state has blown up

Real cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<Real>(t.tv_sec) + 1e-9 * static_cast<Real>(t.tv_nsec);
}

class Stopwatch {
 public:
  explicit Stopwatch(Real& total) : total_(total), begin_(cpu_seconds()) {}
  ~Stopwatch() { total_ += cpu_seconds() - begin_; }

 private:
  Real& total_;
  Real begin_;
};

}  // namespace

std::string TileSolver::obstacle(const SceneDesc& scene) {
  const SolverDesc& solver = scene.solver;
  if (solver.precision != Precision::float32) return "the scene asks for double precision";
  if (solver.transfer == Transfer::polypic) return "PolyPIC is in the reference solver only";
  if (solver.transfer == Transfer::xpic) return "XPIC is in the reference solver only";
  if (solver.transfer == Transfer::flip) return "FLIP is in the reference solver only";
  if (solver.kernel != Kernel::quadratic) return "the cubic kernel is in the reference solver only";
  if (solver.force_form != ForceForm::mls)
    return "the gradient force is in the reference solver only";
  if (solver.deformation_update != DeformationUpdate::exponential)
    return "the linear deformation update is in the reference solver only";
  for (const BodyDesc& body : scene.bodies)
    if (body.force == ForceKind::mesh) return "mesh forces are in the reference solver only";
  if (!tile_kernels()) return "this CPU (or REND_SIMD) has no instruction set with vector kernels";
  return "";
}

TileSolver::StepSums& TileSolver::StepSums::operator+=(const StepSums& other) {
  motion += other.motion;
  dissipation += other.dissipation;
  excess = std::max(excess, other.excess);
  finite = finite && other.finite;
  return *this;
}

Real TileSolver::Material::stiffness(const RunExtremes& extremes) const {
  const Lame lame = lame_parameters(desc.youngs_modulus, desc.poisson_ratio);
  return wave_stiffness(lame.mu, lame.lambda, extremes.least_stress) / desc.density;
}

TileSolver::TileSolver(const SceneDesc& scene, const Model& model, const TileKernels* kernels)
    : scene_(scene),
      dx_(scene.grid.dx),
      density_(scene.materials.at(0).density),
      kernels_(kernels ? kernels : tile_kernels()),
      strength_(model.strength),
      material_of_(model.material),
      scene_hash_(hash_scene(scene, model)),
      gravity_(scene.gravity) {
  for (const MaterialDesc& material : scene.materials)
    materials_.push_back({material, constants_of(material)});
  place(model);
  measure_motion();
  fill_report(report_);
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

// Groups that the materials need now, after those that are there already.
TileLayout TileSolver::needed_layout() const {
  TileLayout layout = store_.layout();
  const auto any_material = [&](auto&& test) {
    return std::any_of(materials_.begin(), materials_.end(),
                       [&](const Material& m) { return test(m.desc); });
  };
  if (layout.tau_c < 0 &&
      any_material([](const MaterialDesc& m) { return m.yield_surface.type != 0; }))
    layout.tau_c = layout.groups++;
  if (layout.tau_c0 < 0 && !strength_.empty() &&
      any_material([](const MaterialDesc& m) { return m.damage.type != DamageType::off; }))
    layout.tau_c0 = layout.groups++;
  return layout;
}

void TileSolver::place(const Model& model) {
  const TileLayout layout = needed_layout();

  std::vector<TileStore::Arrival> arrivals(model.X.size());
  for (std::size_t i = 0; i < model.X.size(); ++i) {
    const Vec3 cells = model.X[i] / dx_;
    if (!(cells.cwiseAbs().maxCoeff() < 4.0 * (TileStore::kLimit - 2)))
      throw Error("/bodies",
                  fmt::format("particle {} at ({}, {}, {}) m is outside +-2^20 cells of {} m", i,
                              model.X[i][0], model.X[i][1], model.X[i][2], dx_));
    TileStore::Arrival& a = arrivals[i];
    a.id = static_cast<Index>(i);
    a.material = model.material[i];
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
  });

  spare_.reserve(std::size_t(store_.tile_count()) * std::max(kMotionFloats, layout.floats()));
  std::fill(motion(), motion() + std::size_t(store_.tile_count()) * kMotionFloats, 0.0f);
  for (std::size_t slot = 0; slot < store_.ids().size(); ++slot) {
    if (store_.ids()[slot] < 0) continue;
    const auto i = static_cast<std::size_t>(store_.ids()[slot]);
    float* lane = motion() + slot / kLanes * kMotionFloats + slot % kLanes;
    for (int a = 0; a < 3; ++a) lane[a * kLanes] = static_cast<float>(model.velocity[i][a] / dx_);
    if (model.body[i] >= model.velocity_gradient.size()) continue;
    const Mat3& L = model.velocity_gradient[model.body[i]];
    if (scene_.solver.transfer == Transfer::apic || scene_.solver.transfer == Transfer::rpic)
      for (int a = 0; a < 9; ++a) lane[(3 + a) * kLanes] = static_cast<float>(L(a / 3, a % 3));
  }
  update_topology();
}

StepConstants TileSolver::step_constants(Real dt, Real next_dt) const {
  StepConstants step;
  step.layout = store_.layout();
  step.dt = static_cast<float>(dt);
  step.stress_factor = static_cast<float>(-4 * next_dt / (density_ * dx_ * dx_));
  const Real r = scene_.solver.rpic_blend;
  switch (scene_.solver.transfer) {
    case Transfer::pic:
      step.affine_keep = 0;
      break;
    case Transfer::rpic:
      step.affine_keep = static_cast<float>(0.5 * (r + 1));
      step.affine_swap = static_cast<float>(0.5 * (r - 1));
      break;
    default:
      break;
  }
  return step;
}

// ---- one step

TileSolver::StepSums TileSolver::particle_pass(Pass pass, const StepConstants& step) {
  const Stopwatch watch(times_.particles);
  const auto kernel = kernels_->particles[static_cast<int>(pass)];
  run_extremes_.resize(store_.runs().size());
  return ordered_sum(static_cast<Index>(store_.blocks().size()), 1, StepSums(), [&](Index b) {
    const TileBlock& block = store_.blocks()[static_cast<std::size_t>(b)];
    ParticleRun few[4];
    std::vector<ParticleRun> many;
    ParticleRun* runs = few;
    if (block.run_count > 4) {
      many.resize(static_cast<std::size_t>(block.run_count));
      runs = many.data();
    }
    for (int r = 0; r < block.run_count; ++r) {
      const TileRun& run = store_.runs()[static_cast<std::size_t>(block.first_run + r)];
      runs[r] = {store_.tile(run.first_tile),
                 motion() + std::size_t(run.first_tile) * kMotionFloats,
                 &materials_[run.material].constants, run.count};
    }
    BlockTask task;
    task.runs = runs;
    task.extremes = run_extremes_.data() + block.first_run;
    task.run_count = block.run_count;
    task.grid = grid_.all_nodes();
    task.neighbors = grid_.neighbors(b).data();
    for (int a = 0; a < 3; ++a) {
      task.low[a] = block.low(a);
      task.high[a] = block.high(a);
    }
    task.rows = grid_.rows(b);
    task.allowed = grid_.allowed(b);
    kernel(step, task);
    grid_.set_touched(b, task.touched);

    StepSums sums;
    sums.excess = task.excess;
    float speed2 = 0, gradient2 = 0;
    for (int r = 0; r < block.run_count; ++r) {
      const RunExtremes& extremes = task.extremes[r];
      const TileRun& run = store_.runs()[static_cast<std::size_t>(block.first_run + r)];
      sums.motion.stiffness =
          std::max(sums.motion.stiffness, materials_[run.material].stiffness(extremes));
      speed2 = std::max(speed2, extremes.speed2);
      gradient2 = std::max(gradient2, extremes.gradient2);
      sums.dissipation += extremes.dissipation;
      sums.finite = sums.finite && extremes.finite;
    }
    sums.motion.gradient = std::sqrt(static_cast<Real>(gradient2));
    const bool affine = step.affine_keep != 0;
    sums.motion.speed = dx_ * (std::sqrt(static_cast<Real>(speed2)) +
                               (affine ? std::sqrt(3.0) * sums.motion.gradient : 0));
    return sums;
  });
}

Real TileSolver::grid_pass(Real dt) {
  const Stopwatch watch(times_.grid);
  struct Fastest {
    float speed = 0;
    bool finite = true;
    Fastest& operator+=(const Fastest& other) {
      finite = finite && other.finite && std::isfinite(other.speed);
      speed = std::max(speed, other.speed);
      return *this;
    }
  };
  const Vec3 gain = dt / dx_ * gravity_;
  std::vector<std::uint32_t> touched(static_cast<std::size_t>(grid_.count()));
  Fastest fastest = ordered_sum(grid_.count(), 8, Fastest(), [&](Index g) {
    GridTask task = grid_.task(g);
    for (int a = 0; a < 3; ++a) task.velocity_gain[a] = static_cast<float>(gain[a]);
    kernels_->grid(task);
    touched[static_cast<std::size_t>(g)] = task.touched;
    return Fastest{task.max_speed};
  });

  NodeLoads loads(scene_.colliders, pull_, time_ + dt);
  motion_.collider_speed = loads.collider_speed();
  if (loads.none()) return fastest.finite ? fastest.speed : std::nan("");

  const Real node_mass = density_ * dx_ * dx_ * dx_;
  const auto each_node = [&](Index g, auto&& visit) {
    const Vec3 origin = 4.0 * dx_ * grid_.coord(g).cast<Real>();
    float* node = grid_.nodes(g);
    for (int n = 0; n < 64; ++n)
      if ((touched[static_cast<std::size_t>(g)] >> (n / 4) & 1) != 0 && node[4 * n + 3] > 0)
        visit(Vec3(origin + dx_ * Vec3(n >> 4, n >> 2 & 3, n & 3)), node_mass * node[4 * n + 3],
              node + 4 * n);
  };
  if (loads.pulls())
    loads.set_pulled_mass(ordered_sum(grid_.count(), 8, 0.0, [&](Index g) {
      Real mass = 0;
      each_node(g, [&](const Vec3& x, Real m, float*) { mass += m * loads.falloff(x); });
      return mass;
    }));
  const Real radius = 1.5 * std::sqrt(3.0) * dx_;
  struct Loaded {
    Real work = 0;
    Fastest fastest;
    Loaded& operator+=(const Loaded& other) {
      work += other.work;
      fastest += other.fastest;
      return *this;
    }
  };
  const Loaded loaded = ordered_sum(grid_.count(), 8, Loaded(), [&](Index g) {
    Loaded out;
    const Vec3 centre = dx_ * (4.0 * grid_.coord(g).cast<Real>() + Vec3::Constant(1.5));
    const NodeLoads::Near near = loads.near(centre, radius);
    if (near.none()) return out;
    each_node(g, [&](const Vec3& x, Real m, float* node) {
      const Vec3 v = dx_ * Vec3(node[0], node[1], node[2]);
      const Vec3 after = loads.apply(near, x, m, dt, v, out.work);
      for (int a = 0; a < 3; ++a) {
        node[a] = static_cast<float>(after[a] / dx_);
        out.fastest += {std::abs(node[a])};
      }
    });
    return out;
  });
  external_work_ += loaded.work;
  fastest += loaded.fastest;
  return fastest.finite ? fastest.speed : std::nan("");
}

void TileSolver::update_topology() {
  grid_.relate(store_.blocks());
  grid_.rebuild(store_.blocks());
}

// ---- one frame

FrameReport TileSolver::advance(Real duration, const BetweenSteps& between) {
  const auto begin = std::chrono::steady_clock::now();
  FrameReport report;
  report.dt_min = report.dt_max = 0;
  Fault fault;
  good_ = state();
  const Real end = time_ + duration;
  bool complete = true;
  Real dt = 0;
  try {
    if (fault.status == Status::ok && time_ < end) {
      dt = choose_time_step(scene_.solver, dx_, motion_, end - time_);
      if (!(duration / dt < kMostSteps))
        fault = {Status::too_fast, -1, motion_.speed, true};
      else
        particle_pass(Pass::scatter, step_constants(0, dt));
    }
    while (fault.status == Status::ok && time_ < end) {
      const Real fastest = grid_pass(dt);
      const float reach = static_cast<float>(dt * fastest);
      const bool rebin = !(excess_ + reach < kMargin);
      if (rebin) {
        const Stopwatch watch(times_.rebin);
        store_.rebin(spare_);
        grid_.relate(store_.blocks());
        ++times_.rebins;
        if (!(reach < kMargin)) {
          fault = {std::isfinite(fastest) ? Status::too_fast : Status::not_finite, -1,
                   fastest * dx_};
          break;
        }
      }
      const Real after = dt < end - time_ ? time_ + dt : end;
      if (after < end && between && !between()) complete = false;
      const bool last = after >= end || !complete;
      Real next = 0;
      if (!last) {
        next = choose_time_step(scene_.solver, dx_, motion_, end - after);
        if (!(duration / next < kMostSteps)) {
          fault = {Status::too_fast, -1, motion_.speed, true};
          break;
        }
      }
      if (last)
        spare_.reserve(std::size_t(store_.tile_count()) *
                       std::max(kMotionFloats, store_.layout().floats()));
      const StepSums sums =
          particle_pass(last ? Pass::gather : Pass::fused, step_constants(dt, next));
      if (rebin) {
        const Stopwatch watch(times_.rebin);
        grid_.rebuild(store_.blocks());
      }
      if (!sums.finite || !(sums.excess < 1)) {
        fault = {sums.finite ? Status::too_fast : Status::not_finite, -1, sums.motion.speed};
        break;
      }
      excess_ = std::max(sums.excess, 0.0f);
      const Real collider_speed = motion_.collider_speed;
      motion_ = sums.motion;
      motion_.collider_speed = collider_speed;
      dissipated_ += sums.dissipation * dx_ * dx_ * dx_;
      time_ = after;
      report.dt_min = report.substeps == 0 ? dt : std::min(report.dt_min, dt);
      report.dt_max = std::max(report.dt_max, dt);
      ++report.substeps;
      ++times_.steps;
      dt = next;
      if (last) break;
    }
  } catch (const std::bad_alloc&) {
    fault = {Status::out_of_memory};
  }
  const Real stopped_at = time_;
  if (fault.status == Status::ok) {
    if (complete) ++frame_;
    fill_report(report);
    if (!std::isfinite(report.kinetic_energy + report.elastic_energy + report.gravity_energy))
      fault = {Status::not_finite};
    else
      fault = farthest_block();
    if (fault.status != Status::ok && complete) --frame_;
  }
  if (fault.status != Status::ok) {
    if (fault.particle < 0 && !fault.tiny_step) fault.particle = suspect();
    restore(good_);
    fill_report(report);
  }
  report.status = fault.status;
  report.culprit = fault.particle;
  report.reason = rend::describe(fault, stopped_at);
  report.sim_seconds =
      std::chrono::duration<Real>(std::chrono::steady_clock::now() - begin).count();
  report_ = report;
  return report;
}

}  // namespace rend
