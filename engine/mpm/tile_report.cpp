// What the tile solver tells.
#include "engine/core/parallel.h"
#include "engine/core/random.h"
#include "engine/mpm/node_loads.h"
#include "engine/mpm/tile_solver.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace rend {

namespace {

// Volumes in cells are floats, so that whole multiples of this unit add up exactly, in any order.
constexpr Real kVolumeUnit = 0x1p-44;
// 64 bits would hold 2^19 cells: four million particles.
__extension__ typedef __int128 VolumeSum;

struct ReportSums {
  Real kinetic = 0, affine = 0, elastic = 0, gravity = 0, power = 0, max_speed2 = 0;
  std::vector<VolumeSum> volume;  // of each material, in units
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  Index yielded = 0, damaged = 0;
  ReportSums& operator+=(const ReportSums& o) {
    for (std::size_t m = 0; m < o.volume.size(); ++m) volume[m] += o.volume[m];
    kinetic += o.kinetic;
    affine += o.affine;
    elastic += o.elastic;
    gravity += o.gravity;
    power += o.power;
    max_speed2 = std::max(max_speed2, o.max_speed2);
    momentum += o.momentum;
    angular += o.angular;
    yielded += o.yielded;
    damaged += o.damaged;
    return *this;
  }
};

}  // namespace

template <class F>
void TileSolver::each_run(F&& visit) const {
  parallel_for(static_cast<Index>(store_.blocks().size()), 4, [&](Index b) {
    const TileBlock& block = store_.blocks()[static_cast<std::size_t>(b)];
    for (int r = 0; r < block.run_count; ++r)
      visit(store_.runs()[static_cast<std::size_t>(block.first_run + r)], block);
  });
}

Real TileSolver::tau_c0(std::size_t material, Index id) const {
  return initial_threshold(materials_[material].desc.yield_surface) *
         (strength_.empty() ? 1.0 : static_cast<Real>(strength_[static_cast<std::size_t>(id)]));
}

bool TileSolver::is_damaged(std::size_t material, float tau_c) const {
  const MaterialDesc& desc = materials_[material].desc;
  return desc.yield_surface.type != 0 && desc.damage.type != DamageType::off && !(tau_c > 0);
}

// One particle of a run: its place in the tile, in the motion, and its id.
struct TileSolver::Lane {
  const float* tile;
  const float* motion;
  Index id;

  float x(int a) const { return tile[a * kLanes]; }
  float v(int a) const { return motion[a * kLanes]; }
  float C(int i) const { return motion[(3 + i) * kLanes]; }
  float volume() const { return std::abs(tile[TileLayout::kVolume * kLanes]); }
  bool yielded() const { return std::signbit(tile[TileLayout::kVolume * kLanes]); }
};

TileSolver::Lane TileSolver::lane(const TileRun& run, int i) const {
  const std::int32_t t = run.first_tile + i / kLanes;
  return {store_.tile(t) + i % kLanes, motion() + std::size_t(t) * kMotionFloats + i % kLanes,
          store_.ids()[std::size_t(run.first_tile) * kLanes + static_cast<std::size_t>(i)]};
}

float TileSolver::tau_c(const Lane& lane) const {
  return store_.layout().tau_c < 0 ? 1.0f : lane.tile[store_.layout().tau_c * kLanes];
}

Vec3 TileSolver::world_position(const TileBlock& block, const Lane& lane) const {
  return dx_ * (4.0 * block.coord.cast<Real>() + Vec3(lane.x(0), lane.x(1), lane.x(2)));
}

std::vector<TileSolver::Point> TileSolver::points() const {
  std::vector<Point> out(static_cast<std::size_t>(store_.particle_count()));
  each_run([&](const TileRun& run, const TileBlock& block) {
    for (int i = 0; i < run.count; ++i) {
      const Lane p = lane(run, i);
      Point& point = out[static_cast<std::size_t>(p.id)];
      point.x = world_position(block, p);
      point.v = dx_ * Vec3(p.v(0), p.v(1), p.v(2));
      for (int k = 0; k < 9; ++k) point.C(k / 3, k % 3) = p.C(k);
      const auto e = [&](int k) {
        return static_cast<Real>(p.tile[(TileLayout::kStrain + k) * kLanes]);
      };
      point.strain << e(0), e(3), e(5), e(3), e(1), e(4), e(5), e(4), e(2);
      if (on_mesh(run)) point.strain.setZero();
      point.tau_c = tau_c(p);
    }
  });
  return out;
}

Snapshot TileSolver::snapshot() const {
  Snapshot out;
  const auto count = static_cast<std::size_t>(store_.particle_count());
  out.frame = frame_;
  out.time = time_;
  out.x.resize(count);
  out.v.resize(count);
  out.damage.resize(count);
  out.stress.resize(count);
  out.yielded.resize(count);
  const TileMesh::Measure elements = mesh_.measure(*kernels_);
  each_run([&](const TileRun& run, const TileBlock& block) {
    const std::vector<float> stress = measure(run).stress;
    for (int i = 0; i < run.count; ++i) {
      const Lane p = lane(run, i);
      const auto id = static_cast<std::size_t>(p.id);
      out.x[id] = world_position(block, p);
      out.v[id] = (dx_ * Vec3(p.v(0), p.v(1), p.v(2))).cast<float>();
      if (on_mesh(run)) {
        const VertexState vertex = mesh_.at_vertex(elements, p.id);
        out.stress[id] = vertex.stress;
        out.yielded[id] = vertex.yielded;
        out.damage[id] = vertex.damage;
        continue;
      }
      out.stress[id] = stress[static_cast<std::size_t>(i)];
      out.yielded[id] = p.yielded();
      const Real full = tau_c0(run.material, p.id);
      const Real lost = full > 0 && store_.layout().tau_c >= 0 ? 1 - tau_c(p) / full : 0;
      out.damage[id] = is_damaged(run.material, tau_c(p))
                           ? 1.0f
                           : static_cast<float>(std::clamp(lost, 0.0, 1.0));
    }
  });
  out.report = report_;
  return out;
}

// The kernels want aligned memory, and vectors of a tile are small enough for the stack.
TileSolver::RunMeasure TileSolver::measure(const TileRun& run) const {
  alignas(64) float e[kLanes], s[kLanes], w[kLanes];
  RunMeasure out;
  for (int t = 0; t < run.tiles(); ++t) {
    kernels_->measure(store_.layout(), materials_[run.material].constants,
                      store_.tile(run.first_tile + t), 1, e, s,
                      motion() + std::size_t(run.first_tile + t) * kMotionFloats, w);
    out.energy.insert(out.energy.end(), e, e + kLanes);
    out.stress.insert(out.stress.end(), s, s + kLanes);
    out.power.insert(out.power.end(), w, w + kLanes);
  }
  return out;
}

void TileSolver::measure_energy(FrameReport& report) const {
  const Real cell_volume = dx_ * dx_ * dx_;
  ReportSums none;
  none.volume.resize(materials_.size());
  const TileMesh::Measure elements = mesh_.measure(*kernels_);
  const bool affine = keeps_affine_velocity(scene_.solver);
  const ReportSums sums =
      ordered_sum(static_cast<Index>(store_.blocks().size()), 4, none, [&](Index b) {
        const TileBlock& block = store_.blocks()[static_cast<std::size_t>(b)];
        ReportSums sum = none;
        for (int r = 0; r < block.run_count; ++r) {
          const TileRun& run = store_.runs()[static_cast<std::size_t>(block.first_run + r)];
          const RunMeasure measured = measure(run);
          for (int i = 0; i < run.count; ++i) {
            const Lane p = lane(run, i);
            const Real volume = p.volume() * cell_volume;
            const Real m = volume * materials_[run.material].desc.density;
            const Vec3 x = world_position(block, p);
            const Vec3 v = dx_ * Vec3(p.v(0), p.v(1), p.v(2));
            ReportSums one;
            sum.volume[run.material] += std::llround(p.volume() / kVolumeUnit);
            one.momentum = m * v;
            one.angular = m * x.cross(v);
            if (affine) {
              // sum_i w r x (C r), sum_i w r r^T = dx^2/4.
              const Real inertia = m * 0.25 * dx_ * dx_;
              one.angular += inertia * Vec3(p.C(7) - p.C(5), p.C(2) - p.C(6), p.C(3) - p.C(1));
              for (int k = 0; k < 9; ++k)
                one.affine += 0.5 * inertia * static_cast<Real>(p.C(k)) * p.C(k);
            }
            one.kinetic = 0.5 * m * v.squaredNorm();
            one.gravity = -m * gravity_.dot(x);
            one.elastic = volume * measured.energy[static_cast<std::size_t>(i)];
            one.power = m * gravity_.dot(v) - volume * measured.power[static_cast<std::size_t>(i)];
            one.max_speed2 = v.squaredNorm();
            one.yielded = p.yielded();
            one.damaged = is_damaged(run.material, tau_c(p));
            if (on_mesh(run)) {
              const VertexState vertex = mesh_.at_vertex(elements, p.id);
              one.yielded = vertex.yielded;
              one.damaged = vertex.damaged;
              one.power = m * gravity_.dot(v) + dx_ * dx_ * mesh_.force(p.id).dot(v);
            }
            sum += one;
          }
        }
        return sum;
      });
  report.particles = store_.particle_count();
  report.mass = 0;
  for (std::size_t m = 0; m < materials_.size(); ++m)
    report.mass +=
        static_cast<Real>(sums.volume[m]) * kVolumeUnit * cell_volume * materials_[m].desc.density;
  report.momentum = sums.momentum;
  report.angular_momentum = sums.angular;
  report.kinetic_energy = sums.kinetic;
  report.affine_energy = sums.affine;
  report.elastic_energy = sums.elastic + elements.energy * cell_volume;
  report.gravity_energy = sums.gravity;
  report.power = sums.power;
  report.dissipated_energy = balance_.dissipated;
  report.max_speed = std::sqrt(sums.max_speed2);
  report.yielded = sums.yielded;
  report.damaged = sums.damaged;
}

void TileSolver::fill_report(FrameReport& report) {
  report.frame = frame_;
  report.time = time_;
  measure_energy(report);
  balance_.settle(report);
  report.state_hash = state_hash();
}

// A sum over particles of well mixed words does not depend on the order that they are stored in.
std::uint64_t TileSolver::state_hash() const {
  struct Sum {
    std::uint64_t bits = 0;
    Sum& operator+=(const Sum& other) {
      bits += other.bits;
      return *this;
    }
  };
  const Sum sum = ordered_sum(static_cast<Index>(store_.blocks().size()), 8, Sum(), [&](Index b) {
    const TileBlock& block = store_.blocks()[static_cast<std::size_t>(b)];
    Sum out;
    for (int r = 0; r < block.run_count; ++r) {
      const TileRun& run = store_.runs()[static_cast<std::size_t>(block.first_run + r)];
      for (int i = 0; i < run.count; ++i) {
        const Lane p = lane(run, i);
        std::uint64_t hash =
            mix_bits(static_cast<std::uint64_t>(p.id) ^ BlockIndex::key(block.coord) << 1);
        const auto mix = [&](const float* values, int groups) {
          for (int g = 0; g < groups; g += 2) {
            std::uint64_t word = std::bit_cast<std::uint32_t>(values[g * kLanes]);
            if (g + 1 < groups)
              word |= std::uint64_t{std::bit_cast<std::uint32_t>(values[(g + 1) * kLanes])} << 32;
            hash = mix_bits(hash ^ word);
          }
        };
        mix(p.tile, store_.layout().groups);
        mix(p.motion, 12);
        out += Sum{hash};
      }
    }
    return out;
  });
  const std::uint64_t elements = mesh_.empty() ? 0 : mesh_.hash();
  return mix_bits(sum.bits ^ elements ^ std::bit_cast<std::uint64_t>(time_));
}

Index TileSolver::suspect() const {
  Index found = -1;
  float worst = 0;
  for (const TileBlock& block : store_.blocks())
    for (int r = 0; r < block.run_count; ++r) {
      const TileRun& run = store_.runs()[static_cast<std::size_t>(block.first_run + r)];
      for (int i = 0; i < run.count; ++i) {
        const Lane p = lane(run, i);
        float sum = 0, beyond = 0;
        for (int g = 0; g < store_.layout().groups; ++g) sum += p.tile[g * kLanes];
        if (!std::isfinite(sum)) return p.id;
        for (int a = 0; a < 3; ++a)
          beyond = std::max({beyond, p.x(a) - block.high(a), block.low(a) - p.x(a)});
        if (beyond > worst) {
          worst = beyond;
          found = p.id;
        }
      }
    }
  return found;
}

Index TileSolver::first_bad_particle() const {
  Index found = -1;
  for (const TileBlock& block : store_.blocks())
    for (int r = 0; r < block.run_count; ++r) {
      const TileRun& run = store_.runs()[static_cast<std::size_t>(block.first_run + r)];
      for (int i = 0; i < run.count; ++i) {
        const Lane p = lane(run, i);
        float sum = 0;
        for (int g = 0; g < store_.layout().groups; ++g) sum += p.tile[g * kLanes];
        for (int g = 0; g < 12; ++g) sum += p.motion[g * kLanes];
        if (!std::isfinite(sum) && (found < 0 || p.id < found)) found = p.id;
      }
    }
  return found;
}

Fault TileSolver::farthest_block() const {
  for (const TileBlock& block : store_.blocks())
    if (block.coord.cwiseAbs().maxCoeff() > TileStore::kLimit - 2)
      return {Status::left_domain,
              lane(store_.runs()[static_cast<std::size_t>(block.first_run)], 0).id,
              4 * dx_ * block.coord.cwiseAbs().maxCoeff()};
  return {};
}

// Extremes and admissible strain of the current state, as a step of length 0 would leave them.
void TileSolver::measure_motion() {
  struct Sums {
    MotionExtremes motion;
    Real dissipation = 0;
    Sums& operator+=(const Sums& other) {
      motion += other.motion;
      dissipation += other.dissipation;
      return *this;
    }
  };
  const bool affine = keeps_affine_velocity(scene_.solver);
  const Sums sums =
      ordered_sum(static_cast<Index>(store_.blocks().size()), 4, Sums(), [&](Index b) {
        const TileBlock& block = store_.blocks()[static_cast<std::size_t>(b)];
        Sums out;
        for (int r = 0; r < block.run_count; ++r) {
          const TileRun& run = store_.runs()[static_cast<std::size_t>(block.first_run + r)];
          const Material& material = materials_[run.material];
          RunExtremes extremes;
          kernels_->respond(store_.layout(), material.constants, store_.tile(run.first_tile),
                            run.tiles(), extremes);
          out.dissipation += extremes.dissipation;
          out.motion.stiffness = std::max(out.motion.stiffness, material.stiffness(extremes));
          for (int i = 0; i < run.count; ++i) {
            const Lane p = lane(run, i);
            Real C2 = 0;
            for (int k = 0; k < 9; ++k) C2 += static_cast<Real>(p.C(k)) * p.C(k);
            out.motion.gradient = std::max(out.motion.gradient, std::sqrt(C2));
            out.motion.speed = std::max(
                out.motion.speed,
                dx_ * (Vec3(p.v(0), p.v(1), p.v(2)).norm() + (affine ? std::sqrt(3 * C2) : 0)));
          }
        }
        return out;
      });
  motion_ = sums.motion;
  if (!mesh_.empty()) {
    const StepSums elements = mesh_response();
    motion_ += elements.motion;
    balance_.dissipated += elements.dissipation * dx_ * dx_ * dx_;
  }
  motion_.collider_speed = NodeLoads(scene_.colliders, pull_, time_).collider_speed();
  balance_.dissipated += sums.dissipation * dx_ * dx_ * dx_;
}

std::string TileSolver::describe() const {
  const char* transfers[] = {"pic", "flip", "apic", "rpic"};
  std::string features = "strain";
  if (store_.layout().tau_c >= 0) features += ", threshold";
  if (store_.layout().tau_c0 >= 0) features += ", initial threshold";
  if (store_.layout().velocity >= 0) features += ", velocity";
  if (!mesh_.empty()) features += fmt::format(", {} elements", mesh_.element_count());
  return fmt::format("tile solver, float, {}, {}, quadratic kernel, mls force; particles carry {}",
                     kernels_->name, transfers[static_cast<int>(scene_.solver.transfer)], features);
}

double TileSolver::bytes_per_particle() const {
  const double bytes = static_cast<double>(
      store_.bytes() + spare_.size() * sizeof(float) + grid_.bytes() + islands_.bytes() +
      static_cast<std::size_t>(mesh_.bytes()) + run_extremes_.capacity() * sizeof(RunExtremes) +
      strength_.size() * sizeof(float));
  return bytes / std::max<double>(1, store_.particle_count());
}

}  // namespace rend
