// Particles that leave the shared grid for a leg of a few steps: islands, which meet nobody in it.
#pragma once

#include "engine/core/aligned_floats.h"
#include "engine/mpm/tile_store.h"

#include <functional>
#include <vector>

namespace rend {

/// What particles are trusted with during a leg, in cells and seconds. Those of an island stay
/// within `stray` of the straight line that they are on (in free fall), matter on the grid within
/// `reach` of where it is.
struct LegBounds {
  Real time = 0;
  Real stray = 0;
  Real reach = 0;
  Vec3 gravity = Vec3::Zero();  ///< [cells/s2]
};

/// Numbers the groups of blocks that share no node with any other matter during a leg, each with
/// few particles a block and `most` in all; -1 for blocks that stay on the grid, all of them where
/// too few would leave to pay. `bounds` come in with the least stray and reach, which are raised to what the
/// matter needs. may_leave(run) and clear(centre, radius) [cells] tell which particles and places
/// are out of the question.
std::vector<std::int32_t> find_islands(const TileStore& store, const float* motion,
                                       LegBounds& bounds, Index most,
                                       const std::function<bool(const TileRun&)>& may_leave,
                                       const std::function<bool(const Vec3&, Real)>& clear);

/// Copies of the store's parked particles, packed sixteen to a tile across islands.
class IslandTiles {
 public:
  /// Whole islands, or a part of a large one, for one kernel call. Without nodes when every island
  /// is a single particle.
  struct Task {
    std::int32_t first_run = 0, run_count = 0;
    std::int32_t first_node = 0, nodes = 0;
    bool after = false, before = false;  ///< the task after, before it is the next part
    bool is_part() const { return after || before; }
  };

  /// Copies parked blocks and their motion out of the store; `island` has one number per parked
  /// block.
  void pack(const TileStore& store, const float* motion, const std::vector<std::int32_t>& island,
            const LegBounds& bounds);
  /// Copies them back.
  void unpack(TileStore& store, float* motion) const;
  void clear() { tasks_.clear(); }

  bool empty() const { return tasks_.empty(); }
  const std::vector<Task>& tasks() const { return tasks_; }
  const TileRun& run(std::int32_t r) const { return runs_[static_cast<std::size_t>(r)]; }
  float* tile(std::int32_t t) { return tiles_.data() + std::size_t(t) * floats_; }
  float* motion(std::int32_t t) { return motion_.data() + std::size_t(t) * kMotionFloats; }
  /// Room for motion that others still read; only for tasks that are parts.
  float* next_motion(std::int32_t t) { return next_.data() + std::size_t(t) * kMotionFloats; }
  ParticleRun particles(std::int32_t r, const MaterialConstants& material) {
    return {tile(run(r).first_tile), motion(run(r).first_tile), &material, run(r).count};
  }
  bool has_parts() const { return has_parts_; }
  const IslandLanes* lanes(std::int32_t t) const { return lanes_.data() + t; }
  /// Nodes to make room for: a stencil that begins at the last of `nodes` ends behind them.
  std::size_t room_for(std::int32_t nodes) const {
    return static_cast<std::size_t>(nodes) + static_cast<std::size_t>(stencil_);
  }
  std::size_t bytes() const;

 private:
  // Where a particle came from, the box of nodes of its island (-1 for a single particle), its
  // column of blocks along x, and how far it may come along x during the leg.
  struct Home {
    std::int32_t block;  // among the parked ones
    std::int32_t slot;   // from the block's first tile on
    std::int32_t box;
    int column;
    Real low, high;
    std::uint16_t material;
  };
  struct Box {
    Vec3i low, count;
    std::int32_t first = 0;
  };

  std::size_t home_slot(const TileStore& store, const Home& home) const;
  void add_task(std::vector<Home>& members, std::int32_t first_node, std::int32_t nodes);
  void add_parts(const std::vector<Home>& island, const Box& box);

  int floats_ = 0;
  bool has_parts_ = false;
  std::int32_t stencil_ = 0;  ///< most nodes from first to last of a stencil, and a vector
  std::vector<Task> tasks_;
  std::vector<TileRun> runs_;
  std::vector<Home> home_;  ///< by slot
  std::vector<Box> boxes_;
  std::vector<IslandLanes> lanes_;
  AlignedFloats tiles_, motion_, next_;
};

}  // namespace rend
