// Counting sorts by block, material and cell.
#include "engine/mpm/tile_store.h"

#include "engine/core/parallel.h"
#include "engine/mpm/block_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <tuple>

namespace rend {

namespace {

constexpr int kNeighbors = 27;
constexpr float kMostVolume = 65536;  // of a particle, cells; those of scenes have ten at most

Vec3i neighbor_offset(int k) { return Vec3i(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1); }

int cell_of(float x) { return std::clamp(static_cast<int>(std::floor(x + 0.5f)), 0, 3); }

int cell_index(const float* x, int stride) {
  return (cell_of(x[0]) * 4 + cell_of(x[stride])) * 4 + cell_of(x[2 * stride]);
}

std::uint8_t halves_of_cell(int cell) {
  const auto half = [](int c) { return c < 2 ? 1 : 2; };
  return static_cast<std::uint8_t>(half(cell >> 4) | half(cell >> 2 & 3) << 2 |
                                   half(cell & 3) << 4);
}

}  // namespace

void TileStore::lay_out_tiles(std::vector<TileRun>& runs) {
  tile_count_ = 0;
  particle_count_ = 0;
  for (TileRun& run : runs) {
    run.first_tile = tile_count_;
    tile_count_ += run.tiles();
    particle_count_ += run.count;
  }
}

// Pad lanes follow the last particle of the run without mass: a place of their own would cost the
// scatter a flush.
void TileStore::pad(const TileRun& run) {
  const int used = run.count % kLanes;
  if (used == 0) return;
  float* last = tile(run.first_tile + run.tiles() - 1);
  for (int g = 0; g < layout_.groups; ++g)
    for (int l = used; l < kLanes; ++l)
      last[g * kLanes + l] = g == TileLayout::kVolume ? 0 : last[g * kLanes + used - 1];
}

void TileStore::place(const TileLayout& layout, std::vector<Arrival> arrivals,
                      const std::function<void(float*, Index)>& fill) {
  layout_ = layout;
  const auto order = [](const Arrival& a) {
    return std::tuple(BlockIndex::key(a.block), a.material, cell_index(a.x, 1), a.id);
  };
  std::sort(arrivals.begin(), arrivals.end(),
            [&](const Arrival& a, const Arrival& b) { return order(a) < order(b); });
  blocks_.clear();
  runs_.clear();
  const Arrival* before = nullptr;
  for (const Arrival& a : arrivals) {
    const bool new_block = !before || a.block != before->block;
    if (new_block) {
      blocks_.emplace_back();
      blocks_.back().coord = a.block;
      blocks_.back().first_run = static_cast<std::int32_t>(runs_.size());
    }
    if (new_block || a.material != before->material) {
      runs_.push_back({0, 0, a.material, 0});
      ++blocks_.back().run_count;
    }
    ++runs_.back().count;
    ++blocks_.back().count;
    blocks_.back().halves |= halves_of_cell(cell_index(a.x, 1));
    before = &a;
  }
  regular_count_ = static_cast<Index>(blocks_.size());
  lay_out_tiles(runs_);
  tiles_.reserve(std::size_t(tile_count_) * layout_.floats());
  ids_.assign(std::size_t(tile_count_) * kLanes, -1);
  std::size_t next = 0;
  for (const TileRun& run : runs_) {
    for (int i = 0; i < run.count; ++i, ++next) {
      float* lane = tile(run.first_tile + i / kLanes) + i % kLanes;
      for (int a = 0; a < 3; ++a) lane[a * kLanes] = arrivals[next].x[a];
      fill(lane, arrivals[next].id);
      ids_[std::size_t(run.first_tile) * kLanes + i] = arrivals[next].id;
    }
    pad(run);
  }
}

void TileStore::rebin(AlignedFloats& spare, AlignedFloats* motion) {
  const Index old_count = regular_count_;
  // Particles of every block, grouped by the neighbor that they go to.
  std::vector<std::array<std::int32_t, kNeighbors + 1>> group(static_cast<std::size_t>(old_count));
  std::vector<std::int32_t> slots(ids_.size());
  parallel_for(old_count, 4, [&](Index b) {
    const TileBlock& block = blocks_[b];
    const std::int32_t first = runs_[block.first_run].first_tile * kLanes;
    std::array<std::int32_t, kNeighbors + 1> at{};
    const auto destination = [&](const float* lane) {
      int k = 0;
      for (int a = 0; a < 3; ++a) {
        const float x = lane[a * kLanes];
        k = 3 * k + (x < -0.5f ? 0 : x >= 3.5f ? 2 : 1);
      }
      return k;
    };
    const auto each = [&](auto&& visit) {
      for (int r = block.first_run; r < block.first_run + block.run_count; ++r)
        for (int i = 0; i < runs_[r].count; ++i)
          visit(runs_[r].first_tile * kLanes + i,
                destination(tile(runs_[r].first_tile + i / kLanes) + i % kLanes));
    };
    each([&](std::int32_t, int k) { ++at[k + 1]; });
    for (int k = 0; k < kNeighbors; ++k) at[k + 1] += at[k];
    for (int k = 0; k <= kNeighbors; ++k) group[b][k] = first + at[k];
    each([&](std::int32_t slot, int k) { slots[first + at[k]++] = slot; });
  });

  // Blocks that hold particles now, in Morton order, and where their particles come from.
  struct Source {
    std::uint64_t key;
    Index block;
    int neighbor;
  };
  std::vector<Source> sources;
  sources.reserve(blocks_.size() * 2);
  for (Index b = 0; b < old_count; ++b)
    for (int k = 0; k < kNeighbors; ++k)
      if (group[b][k + 1] > group[b][k])
        sources.push_back({BlockIndex::key(blocks_[b].coord + neighbor_offset(k)), b, k});
  std::sort(sources.begin(), sources.end(), [](const Source& a, const Source& b) {
    return std::tie(a.key, a.block, a.neighbor) < std::tie(b.key, b.block, b.neighbor);
  });
  std::vector<TileBlock> blocks;
  std::vector<std::size_t> first_source;
  for (std::size_t s = 0; s < sources.size(); ++s)
    if (s == 0 || sources[s].key != sources[s - 1].key) {
      blocks.emplace_back();
      blocks.back().coord = blocks_[sources[s].block].coord + neighbor_offset(sources[s].neighbor);
      first_source.push_back(s);
    }
  first_source.push_back(sources.size());

  // Calls visit(old slot, material, neighbor it comes through) for the particles of a new block, in
  // a fixed order.
  const auto each_incoming = [&](Index n, auto&& visit) {
    for (std::size_t s = first_source[n]; s < first_source[n + 1]; ++s) {
      const TileBlock& from = blocks_[sources[s].block];
      std::int32_t run = from.first_run;
      for (std::int32_t i = group[sources[s].block][sources[s].neighbor];
           i < group[sources[s].block][sources[s].neighbor + 1]; ++i) {
        while (slots[i] >= (runs_[run].first_tile + runs_[run].tiles()) * kLanes) ++run;
        visit(slots[i], runs_[run].material, sources[s].neighbor);
      }
    }
  };

  const Index new_count = static_cast<Index>(blocks.size());
  std::vector<std::vector<TileRun>> runs_of(blocks.size());
  parallel_for(new_count, 4, [&](Index n) {
    std::vector<TileRun>& runs = runs_of[n];
    each_incoming(n, [&](std::int32_t, std::uint16_t material, int) {
      auto at = std::lower_bound(runs.begin(), runs.end(), material,
                                 [](const TileRun& r, std::uint16_t m) { return r.material < m; });
      if (at == runs.end() || at->material != material) at = runs.insert(at, {0, 0, material, 0});
      ++at->count;
      ++blocks[n].count;
    });
  });
  std::vector<TileRun> runs;
  for (Index n = 0; n < new_count; ++n) {
    blocks[n].first_run = static_cast<std::int32_t>(runs.size());
    blocks[n].run_count = static_cast<std::int32_t>(runs_of[n].size());
    runs.insert(runs.end(), runs_of[n].begin(), runs_of[n].end());
  }
  std::vector<std::int32_t> parked;  // first tiles of their runs, before
  for (std::size_t b = static_cast<std::size_t>(old_count); b < blocks_.size(); ++b) {
    blocks.push_back(blocks_[b]);
    blocks.back().first_run = static_cast<std::int32_t>(runs.size());
    for (int r = 0; r < blocks_[b].run_count; ++r) {
      runs.push_back(runs_[blocks_[b].first_run + r]);
      parked.push_back(runs.back().first_tile);
    }
  }
  lay_out_tiles(runs);

  const int floats = layout_.floats();
  spare.reserve(std::size_t(tile_count_) * floats);
  AlignedFloats motion_there;
  if (motion) {
    motion_there.reserve(std::size_t(tile_count_) * std::max(kMotionFloats, floats));
    std::fill(motion_there.data(), motion_there.data() + std::size_t(tile_count_) * kMotionFloats,
              0.0f);
  }
  std::vector<Index> ids(std::size_t(tile_count_) * kLanes, -1);
  parallel_for(new_count, 4, [&](Index n) {
    TileBlock& block = blocks[n];
    std::vector<std::array<std::int32_t, 65>> next(block.run_count);
    const auto run_of = [&](std::uint16_t material) {
      int r = 0;
      while (runs[block.first_run + r].material != material) ++r;
      return r;
    };
    const auto moved = [&](std::int32_t slot, int k, float* x) {
      const float* lane = tile(slot / kLanes) + slot % kLanes;
      const Vec3i offset = neighbor_offset(k);
      for (int a = 0; a < 3; ++a) x[a] = lane[a * kLanes] - 4.0f * static_cast<float>(offset[a]);
      return lane;
    };
    float x[3];
    each_incoming(n, [&](std::int32_t slot, std::uint16_t material, int k) {
      moved(slot, k, x);
      const int cell = cell_index(x, 1);
      block.halves |= halves_of_cell(cell);
      ++next[run_of(material)][cell + 1];
    });
    for (auto& at : next)
      for (int c = 0; c < 64; ++c) at[c + 1] += at[c];
    each_incoming(n, [&](std::int32_t slot, std::uint16_t material, int k) {
      const float* from = moved(slot, k, x);
      const int r = run_of(material);
      const std::int32_t to =
          runs[block.first_run + r].first_tile * kLanes + next[r][cell_index(x, 1)]++;
      float* lane = spare.data() + std::size_t(to / kLanes) * floats + to % kLanes;
      for (int a = 0; a < 3; ++a) lane[a * kLanes] = x[a];
      for (int g = 3; g < layout_.groups; ++g) lane[g * kLanes] = from[g * kLanes];
      ids[to] = ids_[slot];
      for (int g = 0; motion && g < kMotionFloats; g += kLanes)
        motion_there.data()[std::size_t(to / kLanes) * kMotionFloats + g + to % kLanes] =
            motion->data()[std::size_t(slot / kLanes) * kMotionFloats + g + slot % kLanes];
    });
  });
  parallel_for(static_cast<Index>(parked.size()), 64, [&](Index n) {
    const TileRun& run = runs[runs.size() - parked.size() + n];
    const std::int32_t from = parked[n], to = run.first_tile;
    std::copy(tile(from), tile(from + run.tiles()), spare.data() + std::size_t(to) * floats);
    std::copy(ids_.begin() + from * kLanes, ids_.begin() + (from + run.tiles()) * kLanes,
              ids.begin() + to * kLanes);
  });
  regular_count_ = new_count;
  std::swap(tiles_, spare);
  if (motion) std::swap(*motion, motion_there);
  ids_.swap(ids);
  blocks_.swap(blocks);
  runs_.swap(runs);
  parallel_for(static_cast<Index>(runs_.size()), 64, [&](Index r) { pad(runs_[r]); });
}

TileStore::State TileStore::state() const {
  const std::size_t floats = std::size_t(tile_count_) * layout_.floats();
  return {layout_, blocks_, runs_, ids_, std::vector<float>(tiles_.data(), tiles_.data() + floats)};
}

void TileStore::park(const std::vector<std::uint8_t>& flags) {
  std::vector<TileBlock> regular, parked;
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    (flags[b] ? parked : regular).push_back(blocks_[b]);
  regular_count_ = static_cast<Index>(regular.size());
  regular.insert(regular.end(), parked.begin(), parked.end());
  blocks_.swap(regular);
}

float TileStore::release() {
  float farthest = 0;
  for (std::size_t b = static_cast<std::size_t>(regular_count_); b < blocks_.size(); ++b)
    for (int r = 0; r < blocks_[b].run_count; ++r) {
      const TileRun& run = runs_[blocks_[b].first_run + r];
      pad(run);
      for (int i = 0; i < run.count; ++i) {
        const float* lane = tile(run.first_tile + i / kLanes) + i % kLanes;
        for (int a = 0; a < 3; ++a)
          farthest = std::max({farthest, lane[a * kLanes] - blocks_[b].high(a),
                               blocks_[b].low(a) - lane[a * kLanes]});
      }
    }
  regular_count_ = static_cast<Index>(blocks_.size());
  return farthest;
}

bool TileStore::State::fits(Index count, std::size_t materials) const {
  const auto is_group = [&](int at, int groups) {
    return at == -1 || (at >= 10 && at <= layout.groups - groups);
  };
  if (layout.groups < 10 || layout.groups >= 32 || !is_group(layout.tau_c, 1) ||
      !is_group(layout.tau_c0, 1) || !is_group(layout.velocity, 3))
    return false;
  std::int64_t particles = 0, tile_total = 0;
  std::vector<std::int64_t> first_tile;
  for (const TileRun& run : runs) {
    if (run.count < 1 || run.material >= materials) return false;
    first_tile.push_back(tile_total);
    particles += run.count;
    tile_total += run.tiles();
  }
  if (particles != count || ids.size() != static_cast<std::size_t>(tile_total) * kLanes ||
      tiles.size() != ids.size() * static_cast<std::size_t>(layout.groups))
    return false;

  std::vector<std::uint64_t> keys;
  std::vector<std::uint8_t> owned(runs.size(), 0), seen(static_cast<std::size_t>(count), 0);
  for (const TileBlock& block : blocks) {
    if (block.first_run < 0 || block.run_count < 1 ||
        block.first_run + std::int64_t{block.run_count} > static_cast<std::int64_t>(runs.size()) ||
        block.coord.minCoeff() < -kLimit || block.coord.maxCoeff() > kLimit)
      return false;
    keys.push_back(BlockIndex::key(block.coord));
    std::int64_t held = 0;
    for (int r = block.first_run; r < block.first_run + block.run_count; ++r) {
      if (owned[static_cast<std::size_t>(r)]++ != 0) return false;
      held += runs[static_cast<std::size_t>(r)].count;
    }
    if (held != block.count) return false;
  }
  std::sort(keys.begin(), keys.end());
  if (std::adjacent_find(keys.begin(), keys.end()) != keys.end() ||
      std::find(owned.begin(), owned.end(), 0) != owned.end())
    return false;

  for (std::size_t r = 0; r < runs.size(); ++r)
    for (std::int32_t i = 0; i < runs[r].tiles() * kLanes; ++i) {
      const auto slot = static_cast<std::size_t>(first_tile[r] * kLanes + i);
      const Index id = ids[slot];
      if (i >= runs[r].count ? id != -1 : id < 0 || id >= count) return false;
      if (id >= 0 && seen[static_cast<std::size_t>(id)]++ != 0) return false;
      // Particles are within a cell of their block, and pads have no volume.
      const float* lane =
          tiles.data() + slot / kLanes * static_cast<std::size_t>(layout.floats()) + slot % kLanes;
      const float volume = std::abs(lane[TileLayout::kVolume * kLanes]);
      if (id < 0 ? volume != 0 : !(volume > 0 && volume <= kMostVolume)) return false;
      for (int a = 0; a < 3; ++a)
        if (!(lane[a * kLanes] >= -2 && lane[a * kLanes] <= 5)) return false;
    }
  return true;
}

void TileStore::change_layout(const TileLayout& layout) {
  const TileLayout before = layout_;
  AlignedFloats changed;
  changed.reserve(std::size_t(tile_count_) * layout.floats());
  std::fill(changed.data(), changed.data() + std::size_t(tile_count_) * layout.floats(), 0.0f);
  for (std::int32_t t = 0; t < tile_count_; ++t) {
    const float* from = tile(t);
    float* to = changed.data() + std::size_t(t) * layout.floats();
    const auto copy = [&](int old_group, int new_group, int groups) {
      if (old_group >= 0 && new_group >= 0)
        std::copy(from + old_group * kLanes, from + (old_group + groups) * kLanes,
                  to + new_group * kLanes);
    };
    copy(0, 0, 10);
    copy(before.tau_c, layout.tau_c, 1);
    copy(before.tau_c0, layout.tau_c0, 1);
    copy(before.velocity, layout.velocity, 3);
  }
  layout_ = layout;
  std::swap(tiles_, changed);
}

void TileStore::restore(const State& state) {
  layout_ = state.layout;
  blocks_ = state.blocks;
  runs_ = state.runs;
  ids_ = state.ids;
  regular_count_ = static_cast<Index>(blocks_.size());
  lay_out_tiles(runs_);
  tiles_.reserve(state.tiles.size());
  std::copy(state.tiles.begin(), state.tiles.end(), tiles_.data());
}

std::size_t TileStore::bytes() const {
  return tiles_.size() * sizeof(float) + ids_.capacity() * sizeof(Index) +
         runs_.capacity() * sizeof(TileRun) + blocks_.capacity() * sizeof(TileBlock);
}

}  // namespace rend
