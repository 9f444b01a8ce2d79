// Binning particles into blocks and finding the grid blocks they touch.
#include "engine/mpm/block_grid.h"

#include "engine/core/parallel.h"
#include "engine/core/random.h"

#include <algorithm>

namespace rend {

namespace {

constexpr std::uint64_t kEmpty = ~std::uint64_t(0);
constexpr Index kGrain = 4096;

// 21 bits per axis, biased so that keys sort like coordinates.
std::uint64_t pack(const Vec3i& block) {
  const auto part = [](int c) { return static_cast<std::uint64_t>(c + (1 << 20)); };
  return part(block[0]) << 42 | part(block[1]) << 21 | part(block[2]);
}

Vec3i unpack(std::uint64_t key) {
  const auto part = [&](int shift) {
    return static_cast<int>(key >> shift & 0x1fffff) - (1 << 20);
  };
  return {part(42), part(21), part(0)};
}

// Open-addressing table from block key to the index at which it was first seen.
class BlockTable {
 public:
  explicit BlockTable(std::size_t expected) { resize(expected); }

  Index find_or_add(std::uint64_t key) {
    std::size_t at = mix_bits(key) & mask_;
    while (slots_[at].key != key) {
      if (slots_[at].key == kEmpty) {
        slots_[at] = {key, static_cast<Index>(keys_.size())};
        keys_.push_back(key);
        if (2 * keys_.size() > slots_.size()) {
          resize(2 * keys_.size());
          return static_cast<Index>(keys_.size()) - 1;
        }
        return slots_[at].index;
      }
      at = (at + 1) & mask_;
    }
    return slots_[at].index;
  }

  const std::vector<std::uint64_t>& keys() const { return keys_; }

 private:
  struct Slot {
    std::uint64_t key = kEmpty;
    Index index = 0;
  };

  void resize(std::size_t expected) {
    std::size_t size = 64;
    while (size < 2 * expected) size *= 2;
    slots_.assign(size, {});
    mask_ = size - 1;
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      std::size_t at = mix_bits(keys_[i]) & mask_;
      while (slots_[at].key != kEmpty) at = (at + 1) & mask_;
      slots_[at] = {keys_[i], static_cast<Index>(i)};
    }
  }

  std::vector<Slot> slots_;
  std::vector<std::uint64_t> keys_;
  std::size_t mask_ = 0;
};

// For each position of `keys` its rank in sorted order.
std::vector<Index> ranks(const std::vector<std::uint64_t>& keys) {
  std::vector<Index> sorted(keys.size()), rank(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) sorted[i] = static_cast<Index>(i);
  std::sort(sorted.begin(), sorted.end(), [&](Index a, Index b) {
    return keys[static_cast<std::size_t>(a)] < keys[static_cast<std::size_t>(b)];
  });
  for (std::size_t i = 0; i < keys.size(); ++i)
    rank[static_cast<std::size_t>(sorted[i])] = static_cast<Index>(i);
  return rank;
}

}  // namespace

void BlockGrid::rebuild(const std::vector<Vec3i>& first_node) {
  const Index count = static_cast<Index>(first_node.size());
  const bool resized = key_.size() != first_node.size();
  key_.resize(first_node.size());
  const Index moved = ordered_sum(count, kGrain, Index(0), [&](Index p) -> Index {
    const auto i = static_cast<std::size_t>(p);
    const std::uint64_t key =
        pack({first_node[i][0] >> 2, first_node[i][1] >> 2, first_node[i][2] >> 2});
    if (key == key_[i]) return 0;
    key_[i] = key;
    return 1;
  });
  if (moved == 0 && !resized) return;

  BlockTable table(particle_blocks_.size() + 1);
  std::vector<Index> block_of(first_node.size());
  std::vector<Index> size;
  for (std::size_t p = 0; p < key_.size(); ++p) {
    const Index b = table.find_or_add(key_[p]);
    block_of[p] = b;
    if (static_cast<std::size_t>(b) == size.size()) size.push_back(0);
    ++size[static_cast<std::size_t>(b)];
  }
  const std::vector<std::uint64_t>& keys = table.keys();
  const std::vector<Index> rank = ranks(keys);

  particle_blocks_.assign(keys.size(), {});
  for (std::size_t b = 0; b < keys.size(); ++b) {
    ParticleBlock& block = particle_blocks_[static_cast<std::size_t>(rank[b])];
    block.coord = unpack(keys[b]);
    block.end = size[b];
  }
  Index begin = 0;
  for (ParticleBlock& block : particle_blocks_) {
    block.begin = begin;
    begin += block.end;
    block.end = block.begin;
  }
  order_.resize(key_.size());
  for (std::size_t p = 0; p < key_.size(); ++p) {
    ParticleBlock& block =
        particle_blocks_[static_cast<std::size_t>(rank[static_cast<std::size_t>(block_of[p])])];
    order_[static_cast<std::size_t>(block.end++)] = static_cast<Index>(p);
  }

  BlockTable touched(2 * particle_blocks_.size());
  for (std::vector<Index>& list : color_) list.clear();
  for (std::size_t b = 0; b < particle_blocks_.size(); ++b) {
    ParticleBlock& block = particle_blocks_[b];
    for (int n = 0; n < 8; ++n)
      block.grid[static_cast<std::size_t>(n)] =
          touched.find_or_add(pack(block.coord + Vec3i(n >> 2, n >> 1 & 1, n & 1)));
    const int c = (block.coord[0] & 1) * 4 + (block.coord[1] & 1) * 2 + (block.coord[2] & 1);
    color_[static_cast<std::size_t>(c)].push_back(static_cast<Index>(b));
  }
  const std::vector<Index> grid_rank = ranks(touched.keys());
  grid_blocks_.resize(touched.keys().size());
  for (std::size_t g = 0; g < grid_blocks_.size(); ++g)
    grid_blocks_[static_cast<std::size_t>(grid_rank[g])] = unpack(touched.keys()[g]);
  for (ParticleBlock& block : particle_blocks_)
    for (Index& g : block.grid) g = grid_rank[static_cast<std::size_t>(g)];
  nodes_.resize(grid_blocks_.size() * kNodes);
  velocities_.resize(grid_blocks_.size() * kNodes);
}

void BlockGrid::clear() {
  parallel_chunks(static_cast<Index>(grid_blocks_.size()), 16, [&](Index begin, Index end) {
    std::fill(nodes(begin), nodes(begin) + static_cast<std::size_t>(end - begin) * kNodes,
              GridNode());
  });
}

double BlockGrid::bytes() const {
  return static_cast<double>(nodes_.size()) * (sizeof(GridNode) + sizeof(NodeVelocity)) +
         static_cast<double>(key_.size()) * (sizeof(key_[0]) + sizeof(order_[0])) +
         static_cast<double>(particle_blocks_.size()) * sizeof(ParticleBlock);
}

}  // namespace rend
