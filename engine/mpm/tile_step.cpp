// The passes of one step of the tile solver.
#include "engine/core/parallel.h"
#include "engine/core/stopwatch.h"
#include "engine/mpm/node_loads.h"
#include "engine/mpm/tile_solver.h"

#include <algorithm>
#include <cmath>

namespace rend {

TileSolver::StepSums& TileSolver::StepSums::operator+=(const StepSums& other) {
  motion += other.motion;
  dissipation += other.dissipation;
  clamped += other.clamped;
  excess = std::max(excess, other.excess);
  fastest = std::max(fastest, other.fastest);
  strayed = std::max(strayed, other.strayed);
  finite = finite && other.finite;
  return *this;
}

StepConstants TileSolver::step_constants(Pass pass, Real dt, Real next_dt) const {
  StepConstants step;
  step.layout = store_.layout();
  step.dt = static_cast<float>(dt);
  step.stress_factor = static_cast<float>(-4 * next_dt / (density_ * dx_ * dx_));
  for (int a = 0; a < 3; ++a) step.common_velocity[a] = common_velocity_[a];
  if (pass == Pass::scatter) return step;
  const Real r = scene_.solver.rpic_blend;
  switch (scene_.solver.transfer) {
    case Transfer::pic:
      step.affine_keep = 0;
      break;
    case Transfer::flip:
      step.affine_keep = 0;
      step.flip_ratio = static_cast<float>(scene_.solver.flip_ratio);
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

TileSolver::StepSums TileSolver::particle_pass(Pass pass, const StepConstants& step, Blocks which) {
  const Stopwatch watch(times_.particles);
  const auto kernel = kernels_->particles[is_flip()][static_cast<int>(pass)];
  run_extremes_.resize(store_.runs().size());
  return ordered_sum(store_.regular_count(), 1, StepSums(), [&](Index b) {
    const TileBlock& block = store_.blocks()[static_cast<std::size_t>(b)];
    if (which != Blocks::all && meets_mesh(block) != (which == Blocks::with_mesh))
      return StepSums();
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
    for (int r = 0; r < block.run_count; ++r)
      sums += sums_of(store_.runs()[static_cast<std::size_t>(block.first_run + r)].material,
                      task.extremes[r]);
    return sums;
  });
}

TileSolver::StepSums TileSolver::sums_of(std::uint16_t material,
                                         const RunExtremes& extremes) const {
  StepSums sums;
  sums.motion.stiffness = materials_[material].stiffness(extremes);
  sums.motion.gradient = std::sqrt(static_cast<Real>(extremes.gradient2));
  const bool affine = keeps_affine_velocity(scene_.solver);
  sums.motion.speed = dx_ * (std::sqrt(static_cast<Real>(extremes.speed2)) +
                             (affine ? std::sqrt(3.0) * sums.motion.gradient : 0));
  sums.fastest = std::sqrt(static_cast<Real>(extremes.speed2));
  sums.dissipation = extremes.dissipation;
  sums.clamped = extremes.clamped;
  sums.finite = extremes.finite;
  return sums;
}

// The nodes' step of the islands of a task; parts of a large island read each other's motion, so
// theirs goes to a place of its own.
Real TileSolver::exchange(Index n) {
  const IslandTiles::Task& own = islands_.tasks()[static_cast<std::size_t>(n)];
  static thread_local std::vector<IslandTask::Tile> tiles;
  static thread_local AlignedFloats nodes;
  tiles.clear();
  for (Index k = n - (own.after ? 1 : 0); k <= n + (own.before ? 1 : 0); ++k) {
    const IslandTiles::Task& of = islands_.tasks()[static_cast<std::size_t>(k)];
    for (std::int32_t r = of.first_run; r < of.first_run + of.run_count; ++r) {
      const TileRun& run = islands_.run(r);
      for (std::int32_t i = 0; i < run.tiles(); ++i) {
        const std::int32_t t = run.first_tile + i;
        IslandTask::Tile& tile = tiles.emplace_back();
        tile.count = std::min(kLanes, run.count - i * kLanes);
        tile.particles = islands_.tile(t);
        tile.motion = islands_.motion(t);
        tile.lanes = islands_.lanes(t);
        if (k == n) tile.out = own.is_part() ? islands_.next_motion(t) : islands_.motion(t);
        tile.density = materials_[run.material].constants.density;
      }
    }
  }
  nodes.reserve(4 * islands_.room_for(own.nodes));
  IslandTask task;
  task.tiles = tiles.data();
  task.tile_count = static_cast<std::int32_t>(tiles.size());
  task.nodes = nodes.data();
  task.first_node = own.first_node;
  task.node_count = own.nodes;
  const Vec3 fall = leg_.time / dx_ * gravity_;
  for (int a = 0; a < 3; ++a) task.fall[a] = static_cast<float>(fall[a]);
  kernels_->islands(task);
  return task.strayed;
}

TileSolver::StepSums TileSolver::island_pass(Pass pass, const StepConstants& step) {
  const Stopwatch watch(times_.islands);
  const Vec3 change = static_cast<Real>(step.dt) / dx_ * gravity_;
  const float gain[3] = {static_cast<float>(change[0]), static_cast<float>(change[1]),
                         static_cast<float>(change[2])};
  const auto kernel = kernels_->lone[static_cast<int>(pass)];
  const Index count = static_cast<Index>(islands_.tasks().size());
  const auto task = [&](Index n) -> const IslandTiles::Task& {
    return islands_.tasks()[static_cast<std::size_t>(n)];
  };
  const bool moves = pass != Pass::scatter;
  StepSums total;
  if (moves && islands_.has_parts())
    total += ordered_sum(count, 1, StepSums(), [&](Index n) {
      StepSums sums;
      if (task(n).is_part()) sums.strayed = exchange(n);
      return sums;
    });
  total += ordered_sum(count, 4, StepSums(), [&](Index n) {
    StepSums sums;
    if (moves && task(n).nodes > 0 && !task(n).is_part()) sums.strayed = exchange(n);
    for (std::int32_t r = task(n).first_run; r < task(n).first_run + task(n).run_count; ++r) {
      const TileRun& run = islands_.run(r);
      if (moves && task(n).is_part())
        std::copy_n(islands_.next_motion(run.first_tile), run.tiles() * kMotionFloats,
                    islands_.motion(run.first_tile));
      RunExtremes extremes;
      kernel(step, islands_.particles(r, materials_[run.material].constants), gain, extremes);
      sums += sums_of(run.material, extremes);
    }
    return sums;
  });
  for (Index n = 0; moves && n < count; ++n)
    for (std::int32_t r = task(n).first_run; r < task(n).first_run + task(n).run_count; ++r)
      (task(n).nodes > 0 ? island_steps_ : lone_steps_) += islands_.run(r).count;
  return total;
}

TileSolver::StepSums TileSolver::every_particle(Pass pass, const StepConstants& step, Real next) {
  StepSums sums = mesh_.empty() ? particle_pass(pass, step) : mesh_pass(pass, step, next);
  if (islands_.empty()) return sums;
  const Real fastest = sums.fastest;  // on the grid
  sums += island_pass(pass, step);
  sums.fastest = fastest;
  return sums;
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
    for (int a = 0; a < 3; ++a) {
      task.velocity_gain[a] = static_cast<float>(gain[a]);
      task.common_velocity[a] = common_velocity_[a];
    }
    kernels_->grid[is_flip()](task);
    touched[static_cast<std::size_t>(g)] = task.touched;
    return Fastest{task.max_speed};
  });

  NodeLoads loads(scene_.colliders, pull_, time_ + dt, node_rule_);
  motion_.collider_speed = loads.collider_speed();
  if (loads.none()) return fastest.finite ? fastest.speed : std::nan("");

  const Real node_mass = density_ * dx_ * dx_ * dx_;
  const Vec3 common = common_velocity_.cast<Real>();
  const auto velocity = [&](const float* node) {
    return Vec3(dx_ * (Vec3(node[0], node[1], node[2]) + common));
  };
  const auto each_node = [&](Index g, auto&& visit) {
    const Vec3 origin = 4.0 * dx_ * grid_.coord(g).cast<Real>();
    float* node = grid_.nodes(g);
    for (int n = 0; n < 64; ++n)
      if ((touched[static_cast<std::size_t>(g)] >> (n / 4) & 1) != 0 && node[4 * n + 3] > 0)
        visit(Vec3(origin + dx_ * Vec3(n >> 4, n >> 2 & 3, n & 3)), node_mass * node[4 * n + 3],
              node + 4 * n);
  };
  if (loads.pulls())
    balance_.nodes.external +=
        loads.set_pulled(ordered_sum(grid_.count(), 8, PulledMatter(),
                                     [&](Index g) {
                                       PulledMatter sum;
                                       each_node(g, [&](const Vec3& x, Real m, const float* node) {
                                         sum += loads.pulled(x, m, velocity(node));
                                       });
                                       return sum;
                                     }),
                         dt, pull_);
  const Real radius = 1.5 * std::sqrt(3.0) * dx_;
  struct Loaded {
    NodeWork work;
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
      const Vec3 v = velocity(node);
      const Vec3 after = loads.apply(near, x, m, dt, v, out.work);
      for (int a = 0; a < 3; ++a) {
        if (is_flip()) node[kGridBlockFloats + a] += static_cast<float>((after[a] - v[a]) / dx_);
        node[a] = static_cast<float>(after[a] / dx_ - common[a]);
        out.fastest += {std::abs(node[a] + common_velocity_[a])};
      }
    });
    return out;
  });
  balance_.nodes += loaded.work;
  fastest += loaded.fastest;
  return fastest.finite ? fastest.speed : std::nan("");
}

}  // namespace rend
