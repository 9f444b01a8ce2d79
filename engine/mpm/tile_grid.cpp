// Topology of the tile solver's grid, rebuilt after a re-bin only.
#include "engine/mpm/tile_grid.h"

#include <algorithm>
#include <bit>

namespace rend {

namespace {

// Neighbors along one axis that particles in these halves, or a cell beyond, touch: bit o + 1 for
// offset o.
constexpr int neighbors_of_halves(int halves) {
  return halves == 1 ? 0b011 : halves == 2 ? 0b110 : 0b111;
}
// Nodes of the tile (0..7) that they touch.
constexpr int nodes_of_halves(int halves) { return halves == 1 ? 0x3f : halves == 2 ? 0xfc : 0xff; }

int halves_along(const TileBlock& block, int axis) { return block.halves >> (2 * axis) & 3; }

bool reaches(const TileBlock& block, int k) {
  return (neighbors_of_halves(halves_along(block, 0)) >> (k / 9) & 1) != 0 &&
         (neighbors_of_halves(halves_along(block, 1)) >> (k / 3 % 3) & 1) != 0 &&
         (neighbors_of_halves(halves_along(block, 2)) >> (k % 3) & 1) != 0;
}

Vec3i offset_of(int k) { return Vec3i(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1); }

}  // namespace

void TileGrid::lay_out_rows(std::span<const TileBlock> blocks) {
  allowed_.resize(blocks.size());
  first_row_.resize(blocks.size());
  rows_of_.assign(blocks.size(), RowsOfBlock{});
  std::size_t total = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const int along_x = nodes_of_halves(halves_along(blocks[b], 0));
    const int along_y = nodes_of_halves(halves_along(blocks[b], 1));
    allowed_[b] = 0;
    for (int x = 0; x < 8; ++x)
      if (along_x >> x & 1) allowed_[b] |= static_cast<std::uint64_t>(along_y) << (8 * x);
    first_row_[b] = total;
    total += static_cast<std::size_t>(std::popcount(allowed_[b]));
  }
  rows_.reserve(total * parts_ * kNodeRowFloats);
}

void TileGrid::rebuild(std::span<const TileBlock> blocks) {
  index_.clear(2 * blocks.size());
  coords_.clear();
  neighbors_.resize(blocks.size());
  std::vector<std::int32_t> source_count;
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (int k = 0; k < 27; ++k) {
      std::int32_t& neighbor = neighbors_[b][k];
      neighbor = -1;
      if (!reaches(blocks[b], k)) continue;
      const Vec3i coord = blocks[b].coord + offset_of(k);
      neighbor = index_.find_or_add(BlockIndex::key(coord), count());
      if (neighbor == count()) {
        coords_.push_back(coord);
        source_count.push_back(0);
      }
      ++source_count[neighbor];
    }
  first_source_.assign(coords_.size() + 1, 0);
  for (std::size_t g = 0; g < coords_.size(); ++g)
    first_source_[g + 1] = first_source_[g] + source_count[g];
  sources_.resize(static_cast<std::size_t>(first_source_.back()));
  std::vector<std::int32_t> next(first_source_.begin(), first_source_.end() - 1);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (int k = 0; k < 27; ++k) {
      std::int32_t& neighbor = neighbors_[b][k];
      if (neighbor >= 0)
        sources_[next[neighbor]++] = {static_cast<std::int32_t>(b), k};
      else
        neighbor = count();
    }
  const std::size_t floats = (coords_.size() + 1) * parts_ * kGridBlockFloats;
  nodes_.reserve(floats);
  std::fill(nodes_.data(), nodes_.data() + floats, 0.0f);
}

void TileGrid::relate(std::span<const TileBlock> blocks) {
  neighbors_.resize(blocks.size());
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (int k = 0; k < 27; ++k) {
      const Index g = index_.find(BlockIndex::key(blocks[b].coord + offset_of(k)));
      neighbors_[b][k] = g < 0 ? count() : g;
    }
  lay_out_rows(blocks);
}

GridTask TileGrid::task(Index g) {
  GridTask task;
  task.sources = sources_.data() + first_source_[g];
  task.source_count = first_source_[g + 1] - first_source_[g];
  task.blocks = rows_of_.data();
  task.nodes = nodes(g);
  return task;
}

std::size_t TileGrid::bytes() const {
  return (nodes_.size() + rows_.size()) * sizeof(float) + index_.bytes() +
         coords_.capacity() * sizeof(Vec3i) + neighbors_.capacity() * sizeof(neighbors_[0]) +
         sources_.capacity() * sizeof(RowSource) + first_source_.capacity() * sizeof(std::int32_t) +
         first_row_.capacity() * sizeof(std::size_t) + allowed_.capacity() * sizeof(std::uint64_t) +
         rows_of_.capacity() * sizeof(RowsOfBlock);
}

}  // namespace rend
