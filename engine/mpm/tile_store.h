// Particles of the tile solver, sorted into blocks, materials and cells, sixteen to a tile.
#pragma once

#include "engine/core/aligned_floats.h"
#include "engine/mpm/tile_kernel.h"

#include <functional>
#include <span>
#include <vector>

namespace rend {

/// Consecutive tiles of one material in one block.
struct TileRun {
  std::int32_t first_tile = 0;
  std::int32_t count = 0;  ///< particles
  std::uint16_t material = 0;
  std::uint16_t unused = 0;  ///< no chance bits in files

  std::int32_t tiles() const { return (count + kLanes - 1) / kLanes; }
};

/// 4^3 cells with particles.
struct TileBlock {
  Vec3i coord = Vec3i::Zero();  ///< in blocks
  std::int32_t first_run = 0, run_count = 0;
  std::int32_t count = 0;  ///< particles
  /// Octants that held particles at the last re-bin, as a box: bit 2a for the lower half of axis a,
  /// bit 2a + 1 for the upper half. Particles stay within one cell of it, which bounds the rows and
  /// grid blocks that they touch.
  std::uint8_t halves = 0;
  std::uint8_t unused[3] = {0, 0, 0};  ///< no chance bits in files

  float low(int axis) const { return halves >> (2 * axis) & 1 ? -0.5f : 1.5f; }
  float high(int axis) const { return halves >> (2 * axis + 1) & 1 ? 3.5f : 1.5f; }
};

/// Particles in an order that depends on nothing but where they are and were. Positions are
/// relative to their block, so that float keeps 2^-22 of a cell anywhere in the world.
class TileStore {
 public:
  static constexpr Index kLimit = Index(1) << 18;  ///< blocks along an axis from the origin

  /// One particle on its way in.
  struct Arrival {
    Vec3i block;
    float x[3];
    std::uint16_t material;
    Index id;
  };

  /// Sorts arrivals into blocks; fill(lane, id) writes everything but the position at lane[16
  /// group].
  void place(const TileLayout& layout, std::vector<Arrival> arrivals,
             const std::function<void(float* lane, Index id)>& fill);

  /// Sorts the particles of regular blocks again where they are now, through `spare`, which then
  /// holds the old tiles. `motion`, where given, has kMotionFloats for every tile, which move
  /// along.
  /// @pre no particle is farther than a block from its own.
  void rebin(AlignedFloats& spare, AlignedFloats* motion = nullptr);

  /// Moves the flagged blocks behind the regular ones; rebin() leaves them alone.
  void park(const std::vector<std::uint8_t>& flags);
  /// Makes all blocks regular. Returns how far any of the parked particles is beyond its block now.
  float release();
  /// The first regular_count() blocks are regular, the rest parked.
  Index regular_count() const { return regular_count_; }

  /// Changes the groups of a tile; the ten that are always there keep their values, as do the
  /// others that both layouts have.
  void change_layout(const TileLayout& layout);

  const TileLayout& layout() const { return layout_; }
  const std::vector<TileBlock>& blocks() const { return blocks_; }
  std::span<const TileBlock> regular_blocks() const {
    return {blocks_.data(), static_cast<std::size_t>(regular_count_)};
  }
  const std::vector<TileRun>& runs() const { return runs_; }
  std::int32_t tile_count() const { return tile_count_; }
  float* tile(std::int32_t t) { return tiles_.data() + std::size_t(t) * layout_.floats(); }
  const float* tile(std::int32_t t) const {
    return tiles_.data() + std::size_t(t) * layout_.floats();
  }
  /// Particle ids by slot (sixteen a tile), -1 in pad lanes.
  const std::vector<Index>& ids() const { return ids_; }
  Index particle_count() const { return particle_count_; }
  std::size_t bytes() const;

  /// Everything that save() must keep.
  struct State {
    TileLayout layout;
    std::vector<TileBlock> blocks;
    std::vector<TileRun> runs;
    std::vector<Index> ids;
    std::vector<float> tiles;
    /// Whether the parts belong together and hold `count` particles of `materials` materials.
    bool fits(Index count, std::size_t materials) const;
  };
  State state() const;
  void restore(const State& state);

 private:
  void lay_out_tiles(std::vector<TileRun>& runs);
  void pad(const TileRun& run);

  TileLayout layout_;
  std::vector<TileBlock> blocks_;
  std::vector<TileRun> runs_;
  std::vector<Index> ids_;
  AlignedFloats tiles_;
  std::int32_t tile_count_ = 0;
  Index regular_count_ = 0;
  Index particle_count_ = 0;
};

}  // namespace rend
