// Grid blocks around the particle blocks of the tile solver, and who adds to whom.
#pragma once

#include "engine/core/aligned_floats.h"
#include "engine/mpm/block_index.h"
#include "engine/mpm/tile_store.h"

#include <array>
#include <span>
#include <vector>

namespace rend {

/// Velocities on 4^3 blocks of nodes and the node rows that particle blocks leave for them. Every
/// grid block sums the rows of its up to 27 particle blocks in a fixed order.
class TileGrid {
 public:
  /// With FLIP nodes have a second part, see parts_of_node().
  explicit TileGrid(bool flip) : parts_(parts_of_node(flip)) {}

  /// Blocks and row memory for the bins as they are; velocities become 0.
  void rebuild(std::span<const TileBlock> blocks);

  /// Looks up where freshly re-binned particle blocks read the velocities of the blocks that there
  /// are.
  void relate(std::span<const TileBlock> blocks);

  Index count() const { return static_cast<Index>(coords_.size()); }
  const Vec3i& coord(Index g) const { return coords_[static_cast<std::size_t>(g)]; }
  /// Velocities of block g, then with FLIP their changes.
  float* nodes(Index g) { return nodes_.data() + std::size_t(g) * parts_ * kGridBlockFloats; }
  const float* all_nodes() const { return nodes_.data(); }
  const std::array<std::int32_t, 27>& neighbors(Index particle_block) const {
    return neighbors_[static_cast<std::size_t>(particle_block)];
  }
  /// Where particle block b writes its rows, and what it may touch.
  float* rows(Index b) { return rows_.data() + first_row_[b] * parts_ * kNodeRowFloats; }
  std::uint64_t allowed(Index b) const { return allowed_[b]; }
  void set_touched(Index b, std::uint64_t touched) { rows_of_[b] = {rows(b), touched}; }

  /// The task of grid block g but for velocity_gain.
  GridTask task(Index g);

  std::size_t bytes() const;

 private:
  void lay_out_rows(std::span<const TileBlock> blocks);

  std::size_t parts_;
  BlockIndex index_;
  std::vector<Vec3i> coords_;
  AlignedFloats nodes_;  ///< one block more than count(): zeros, for neighbors that are not there
  std::vector<std::array<std::int32_t, 27>> neighbors_;
  std::vector<RowSource> sources_;
  std::vector<std::int32_t> first_source_;
  AlignedFloats rows_;
  std::vector<std::size_t> first_row_;
  std::vector<std::uint64_t> allowed_;
  std::vector<RowsOfBlock> rows_of_;
};

}  // namespace rend
