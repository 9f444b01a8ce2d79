// Isolation tests on blocks, and copies in and out.
#include "engine/mpm/tile_lone.h"

#include "engine/core/parallel.h"
#include "engine/mpm/block_index.h"

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

// Stencils of particles that are this far apart along an axis share no node.
constexpr Real kStencil = 3;
// Below this share of single-particle blocks the search costs more than it saves.
constexpr Index kWorthwhile = 100;

// Particles that are in one block now, as their bounding box in cells.
struct Occupied {
  Vec3i coord;
  Vec3 low = Vec3::Constant(1e30), high = Vec3::Constant(-1e30);
  Index count = 0;
  Index home = -1;  // block of the store, when it holds all of them
};

}  // namespace

std::vector<std::uint8_t> find_lone_blocks(
    const TileStore& store, Real reach,
    const std::function<bool(const Vec3&, const TileRun&)>& clear) {
  const std::vector<TileBlock>& blocks = store.blocks();
  std::vector<std::uint8_t> flags(blocks.size(), 0);
  const auto single =
      std::count_if(blocks.begin(), blocks.end(), [](const TileBlock& b) { return b.count == 1; });
  if (single * kWorthwhile < store.particle_count()) return flags;

  BlockIndex index;
  index.clear(2 * blocks.size());
  std::vector<Occupied> occupied;
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (int r = 0; r < blocks[b].run_count; ++r) {
      const TileRun& run = store.runs()[static_cast<std::size_t>(blocks[b].first_run + r)];
      for (int i = 0; i < run.count; ++i) {
        const float* lane = store.tile(run.first_tile + i / kLanes) + i % kLanes;
        const Vec3 x =
            4.0 * blocks[b].coord.cast<Real>() + Vec3(lane[0], lane[kLanes], lane[2 * kLanes]);
        const Vec3i coord = ((x.array() + 0.5) / 4).floor().cast<int>();
        const Index fresh = static_cast<Index>(occupied.size());
        const Index at = index.find_or_add(BlockIndex::key(coord), fresh);
        if (at == fresh) {
          occupied.emplace_back();
          occupied.back().coord = coord;
        }
        Occupied& o = occupied[static_cast<std::size_t>(at)];
        o.low = o.low.cwiseMin(x);
        o.high = o.high.cwiseMax(x);
        o.home = ++o.count == 1 && blocks[b].count == 1 ? static_cast<Index>(b) : -1;
      }
    }
  const Real apart = kStencil + 2 * reach;
  parallel_for(static_cast<Index>(occupied.size()), 256, [&](Index n) {
    const Occupied& o = occupied[static_cast<std::size_t>(n)];
    if (o.home < 0) return;
    const TileBlock& home = blocks[static_cast<std::size_t>(o.home)];
    if (!clear(o.low, store.runs()[static_cast<std::size_t>(home.first_run)])) return;
    for (int k = 0; k < 125; ++k) {
      if (k == 62) continue;
      const Vec3i coord = o.coord + Vec3i(k / 25 - 2, k / 5 % 5 - 2, k % 5 - 2);
      const Index at = index.find(BlockIndex::key(coord));
      if (at < 0) continue;
      const Occupied& other = occupied[static_cast<std::size_t>(at)];
      const Vec3 gap = (other.low - o.low).cwiseMax(o.low - other.high);
      if (gap.maxCoeff() < apart) return;
    }
    flags[static_cast<std::size_t>(o.home)] = 1;
  });
  return flags;
}

// Re-binning of the others moves the tiles of lone blocks, but not the order of the blocks.
std::int32_t LoneTiles::home_tile(const TileStore& store, std::size_t slot) const {
  const TileBlock& block =
      store.blocks()[static_cast<std::size_t>(store.regular_count() + home_[slot])];
  return store.runs()[static_cast<std::size_t>(block.first_run)].first_tile;
}

void LoneTiles::pack(const TileStore& store, const float* motion) {
  floats_ = store.layout().floats();
  runs_.clear();
  home_.clear();
  const auto lone_run = [&](std::size_t b) -> const TileRun& {
    return store.runs()[static_cast<std::size_t>(store.blocks()[b].first_run)];
  };
  const auto first = static_cast<std::size_t>(store.regular_count());
  std::uint16_t materials = 0;
  for (std::size_t b = first; b < store.blocks().size(); ++b)
    materials = std::max<std::uint16_t>(materials, lone_run(b).material + 1);
  for (std::uint16_t m = 0; m < materials; ++m) {
    TileRun run{static_cast<std::int32_t>(home_.size()) / kLanes, 0, m, 0};
    for (std::size_t b = first; b < store.blocks().size(); ++b)
      if (lone_run(b).material == m) {
        home_.push_back(static_cast<std::int32_t>(b - first));
        ++run.count;
      }
    // Pad lanes are copies of the last particle whose results nobody reads.
    while (home_.size() % kLanes != 0) home_.push_back(home_.back());
    if (run.count > 0) runs_.push_back(run);
  }
  tiles_.reserve(home_.size() / kLanes * static_cast<std::size_t>(floats_));
  motion_.reserve(home_.size() / kLanes * kMotionFloats);
  for (std::size_t slot = 0; slot < home_.size(); ++slot) {
    const auto t = static_cast<std::int32_t>(slot) / kLanes;
    const auto l = static_cast<int>(slot) % kLanes;
    const std::int32_t home = home_tile(store, slot);
    const float* from = store.tile(home);
    const float* moves = motion + std::size_t(home) * kMotionFloats;
    for (int g = 0; g < store.layout().groups; ++g) tile(t)[g * kLanes + l] = from[g * kLanes];
    for (int g = 0; g < 12; ++g) this->motion(t)[g * kLanes + l] = moves[g * kLanes];
  }
  for (const TileRun& run : runs_)
    for (int l = run.count; l < run.tiles() * kLanes; ++l)
      tile(run.first_tile + l / kLanes)[TileLayout::kVolume * kLanes + l % kLanes] = 0;
}

void LoneTiles::unpack(TileStore& store, float* motion) const {
  for (const TileRun& run : runs_)
    for (int i = 0; i < run.count; ++i) {
      const std::size_t slot =
          static_cast<std::size_t>(run.first_tile) * kLanes + static_cast<std::size_t>(i);
      const float* from =
          tiles_.data() + slot / kLanes * static_cast<std::size_t>(floats_) + slot % kLanes;
      const float* moves = motion_.data() + slot / kLanes * kMotionFloats + slot % kLanes;
      const std::int32_t home = home_tile(store, slot);
      float* to = store.tile(home);
      for (int g = 0; g < store.layout().groups; ++g) to[g * kLanes] = from[g * kLanes];
      for (int a = 0; a < 3 && store.layout().velocity >= 0; ++a)
        to[(store.layout().velocity + a) * kLanes] = moves[a * kLanes];
      for (int g = 0; g < 12; ++g)
        motion[std::size_t(home) * kMotionFloats + g * kLanes] = moves[g * kLanes];
    }
}

}  // namespace rend
