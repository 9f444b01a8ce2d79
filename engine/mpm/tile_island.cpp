// Copies of particles of islands, in and out, and the boxes of their nodes.
#include "engine/mpm/tile_island.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rend {

namespace {

// Whole islands up to this many particles share a task; larger ones than that are cut into parts.
constexpr std::size_t kParticlesOfTask = 64;
constexpr std::int32_t kNodesOfTask = 1 << 23;  // indices are exact in float
constexpr std::size_t kParticlesOfPart = 1024;

}  // namespace

// Re-binning of the others moves the tiles of parked blocks, but not the order of the blocks.
std::size_t IslandTiles::home_slot(const TileStore& store, const Home& home) const {
  const TileBlock& block =
      store.blocks()[static_cast<std::size_t>(store.regular_count() + home.block)];
  return std::size_t(store.runs()[static_cast<std::size_t>(block.first_run)].first_tile) * kLanes +
         static_cast<std::size_t>(home.slot);
}

void IslandTiles::pack(const TileStore& store, const float* motion,
                       const std::vector<std::int32_t>& island, const LegBounds& bounds) {
  floats_ = store.layout().floats();
  tasks_.clear();
  runs_.clear();
  home_.clear();
  boxes_.clear();
  stencil_ = 0;
  const auto parked = static_cast<std::int32_t>(island.size());
  std::vector<std::int32_t> order(island.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](std::int32_t n) {
    return std::pair(island[n],
                     store.blocks()[static_cast<std::size_t>(store.regular_count() + n)].coord[0]);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });

  // A cell more than particles need, should something speed up in the last step.
  const Real off = bounds.stray + 1;
  std::vector<Home> single, members, here;
  std::int32_t nodes = 0;
  for (std::int32_t n = 0; n < parked;) {
    here.clear();
    Vec3 low = Vec3::Constant(1e30), high = -low;
    const std::int32_t current = island[order[n]];
    for (; n < parked && island[order[n]] == current; ++n) {
      const TileBlock& block =
          store.blocks()[static_cast<std::size_t>(store.regular_count() + order[n])];
      std::int32_t slot = 0;
      for (int r = 0; r < block.run_count; ++r) {
        const TileRun& run = store.runs()[static_cast<std::size_t>(block.first_run + r)];
        for (int i = 0; i < run.count; ++i) {
          const std::int32_t t = run.first_tile + i / kLanes;
          const float* lane = store.tile(t) + i % kLanes;
          const float* moves = motion + std::size_t(t) * kMotionFloats + i % kLanes;
          const Vec3 x =
              4.0 * block.coord.cast<Real>() + Vec3(lane[0], lane[kLanes], lane[2 * kLanes]);
          const Vec3 way = bounds.time * Vec3(moves[0], moves[kLanes], moves[2 * kLanes]) +
                           0.5 * bounds.time * bounds.time * bounds.gravity;
          low = low.cwiseMin(x + way.cwiseMin(0.0));
          high = high.cwiseMax(x + way.cwiseMax(0.0));
          here.push_back({order[n], slot + i, static_cast<std::int32_t>(boxes_.size()),
                          block.coord[0], x[0] + std::min(0.0, way[0]) - off,
                          x[0] + std::max(0.0, way[0]) + off, run.material});
        }
        slot += run.tiles() * kLanes;
      }
    }
    if (here.size() == 1) {
      single.push_back(here[0]);
      single.back().box = -1;
      if (single.size() == kParticlesOfTask) add_task(single, 0, 0);
      continue;
    }
    Box box;
    box.low = (low.array() - (off + 0.5)).floor().cast<int>();
    box.count = (high.array() + (off - 0.5)).floor().cast<int>() + 3 - box.low.array();
    stencil_ = std::max(stencil_, 2 * box.count[2] * (box.count[1] + 1) + 4);
    if (here.size() > kParticlesOfPart) {
      add_parts(here, box);
      boxes_.push_back(box);
      continue;
    }
    const bool full = members.size() + here.size() > kParticlesOfTask ||
                      nodes + box.count.prod() > kNodesOfTask;
    if (!members.empty() && full) {
      add_task(members, 0, nodes);
      nodes = 0;
    }
    box.first = nodes;
    nodes += box.count.prod();
    boxes_.push_back(box);
    members.insert(members.end(), here.begin(), here.end());
  }
  if (!single.empty()) add_task(single, 0, 0);
  if (!members.empty()) add_task(members, 0, nodes);

  const std::size_t tiles = home_.size() / kLanes;
  tiles_.reserve(tiles * static_cast<std::size_t>(floats_));
  motion_.reserve(tiles * kMotionFloats);
  has_parts_ = std::any_of(tasks_.begin(), tasks_.end(), [](const Task& t) { return t.is_part(); });
  if (has_parts_) next_.reserve(tiles * kMotionFloats);
  lanes_.resize(boxes_.empty() ? 0 : tiles);
  for (std::size_t slot = 0; slot < home_.size(); ++slot) {
    const auto t = static_cast<std::int32_t>(slot / kLanes);
    const std::size_t l = slot % kLanes, home = home_slot(store, home_[slot]);
    const float* from = store.tile(static_cast<std::int32_t>(home / kLanes)) + home % kLanes;
    const float* moves = motion + home / kLanes * kMotionFloats + home % kLanes;
    for (int g = 0; g < store.layout().groups; ++g) tile(t)[g * kLanes + l] = from[g * kLanes];
    for (int g = 0; g < 12; ++g) this->motion(t)[g * kLanes + l] = moves[g * kLanes];
    if (home_[slot].box < 0) continue;
    const Box& box = boxes_[static_cast<std::size_t>(home_[slot].box)];
    const TileBlock& block =
        store.blocks()[static_cast<std::size_t>(store.regular_count() + home_[slot].block)];
    const Vec3i stride(box.count[1] * box.count[2], box.count[2], 1);
    IslandLanes& lanes = lanes_[slot / kLanes];
    lanes.origin[l] = static_cast<float>(box.first + stride.dot(4 * block.coord - box.low));
    lanes.stride_x[l] = static_cast<float>(stride[0]);
    lanes.stride_y[l] = static_cast<float>(stride[1]);
    for (int a = 0; a < 3; ++a) lanes.velocity[a][l] = moves[a * kLanes];
  }
  for (const TileRun& run : runs_)
    for (int l = run.count; l < run.tiles() * kLanes; ++l)
      tile(run.first_tile + l / kLanes)[TileLayout::kVolume * kLanes + l % kLanes] = 0;
}

// Cuts an island, which is sorted along x, into slabs. Nodes of a slab are shared with the next
// ones at most: it is thicker than a stencil and the ways of both its neighbors.
void IslandTiles::add_parts(const std::vector<Home>& island, const Box& box) {
  constexpr int kColumns = 3;
  std::vector<std::size_t> cuts = {0};
  for (std::size_t n = 1; n < island.size(); ++n) {
    const std::size_t first = cuts.back();
    const int thick = island[n].column - island[first].column;
    const int left = island.back().column - island[n].column + 1;
    if (island[n].column != island[n - 1].column && n - first >= kParticlesOfPart &&
        thick >= kColumns && left >= kColumns)
      cuts.push_back(n);
  }
  cuts.push_back(island.size());
  const std::int32_t plane = box.count[1] * box.count[2];
  for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
    std::vector<Home> part(island.begin() + static_cast<std::ptrdiff_t>(cuts[c]),
                           island.begin() + static_cast<std::ptrdiff_t>(cuts[c + 1]));
    Real low = 1e30, high = -1e30;
    for (const Home& home : part) {
      low = std::min(low, home.low);
      high = std::max(high, home.high);
    }
    // Stencils that begin up to two nodes before or behind the own ones share some of theirs.
    const int first = static_cast<int>(std::floor(low - 0.5)) - 2 - box.low[0];
    const int last = static_cast<int>(std::floor(high - 0.5)) + 2 - box.low[0];
    add_task(part, first * plane, (last - first + 1) * plane);
    tasks_.back().after = c > 0;
    tasks_.back().before = c + 2 < cuts.size();
  }
}

// Pad lanes are copies of the last particle whose results nobody reads.
void IslandTiles::add_task(std::vector<Home>& members, std::int32_t first_node,
                           std::int32_t nodes) {
  const auto order = [](const Home& a, const Home& b) { return a.material < b.material; };
  if (!std::is_sorted(members.begin(), members.end(), order))
    std::stable_sort(members.begin(), members.end(), order);
  tasks_.push_back({static_cast<std::int32_t>(runs_.size()), 0, first_node, nodes});
  for (std::size_t n = 0; n < members.size(); ++n) {
    const std::uint16_t material = members[n].material;
    if (n == 0 || material != runs_.back().material) {
      while (home_.size() % kLanes != 0) home_.push_back(home_.back());
      runs_.push_back({static_cast<std::int32_t>(home_.size() / kLanes), 0, material, 0});
      ++tasks_.back().run_count;
    }
    ++runs_.back().count;
    home_.push_back(members[n]);
  }
  while (home_.size() % kLanes != 0) home_.push_back(home_.back());
  members.clear();
}

void IslandTiles::unpack(TileStore& store, float* motion) const {
  for (const TileRun& run : runs_)
    for (int i = 0; i < run.count; ++i) {
      const std::size_t slot = std::size_t(run.first_tile) * kLanes + static_cast<std::size_t>(i);
      const float* from =
          tiles_.data() + slot / kLanes * static_cast<std::size_t>(floats_) + slot % kLanes;
      const float* moves = motion_.data() + slot / kLanes * kMotionFloats + slot % kLanes;
      const std::size_t home = home_slot(store, home_[slot]);
      float* to = store.tile(static_cast<std::int32_t>(home / kLanes)) + home % kLanes;
      float* there = motion + home / kLanes * kMotionFloats + home % kLanes;
      for (int g = 0; g < store.layout().groups; ++g) to[g * kLanes] = from[g * kLanes];
      for (int g = 0; g < 12; ++g) there[g * kLanes] = moves[g * kLanes];
      for (int a = 0; a < 3 && store.layout().velocity >= 0; ++a)
        to[(store.layout().velocity + a) * kLanes] = moves[a * kLanes];
    }
}

std::size_t IslandTiles::bytes() const {
  return (tiles_.size() + motion_.size() + next_.size()) * sizeof(float) +
         home_.capacity() * sizeof(Home) + boxes_.capacity() * sizeof(Box) +
         lanes_.capacity() * sizeof(IslandLanes);
}

}  // namespace rend
