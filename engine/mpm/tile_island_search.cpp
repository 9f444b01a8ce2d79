// Which blocks meet whom during a leg.
#include "engine/mpm/tile_island.h"

#include "engine/mpm/block_index.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rend {

namespace {

// Stencils of particles that are this far apart along an axis share no node.
constexpr Real kStencil = 3;
// Blocks with more particles are better off on the grid.
constexpr std::int32_t kFew = 16;
// Below this share of particles in such blocks the search costs more than it saves.
constexpr Index kWorthwhile = 100;
// Indices of nodes are exact in float.
constexpr Real kMostNodes = 1 << 23;
// Blocks on the way of a leg; legs are far shorter.
constexpr Real kMostRange = 64;

// Particles that are in one block's place now, as boxes in cells and cells/s.
struct Bin {
  Vec3i coord;
  Vec3 low = Vec3::Constant(1e30), high = -low;
  Vec3 slow = low, fast = -low;
  Index block = 0;     // of the store; others with particles here belong to its group
  bool bound = false;  // stays on the grid
  bool fixed = false;  // has been found to

  Real speed() const { return std::max(slow.cwiseAbs().maxCoeff(), fast.cwiseAbs().maxCoeff()); }
};

// Blocks that have met, directly or through others.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t root(Index block) {
    auto b = static_cast<std::int32_t>(block);
    while (parent_[b] != b) b = parent_[b] = parent_[parent_[b]];
    return b;
  }
  void join(Index a, Index b) {
    const std::int32_t x = root(a), y = root(b);
    parent_[std::max(x, y)] = std::min(x, y);
  }

 private:
  std::vector<std::int32_t> parent_;
};

class Search {
 public:
  Search(const TileStore& store, const float* motion, LegBounds& bounds, Index most,
         const std::function<bool(const TileRun&)>& may_leave,
         const std::function<bool(const Vec3&, Real)>& clear)
      : store_(store), bounds_(bounds), most_(most), groups_(store.blocks().size()) {
    // What is not finite stays on the grid, where the step finds and names it.
    if (!sort_into_bins(motion, may_leave)) return;
    Vec3 slow = Vec3::Constant(1e30), fast = -slow;
    for (const Bin& bin : bins_)
      if (!bin.bound) {
        slow = slow.cwiseMin(bin.slow);
        fast = fast.cwiseMax(bin.fast);
      }
    const Real spread = std::max(0.0, (fast - slow).maxCoeff());
    bounds.stray = std::clamp(0.5 * spread * bounds.time, bounds.stray, 1.0);
    fall_ = 0.5 * bounds.time * bounds.time * bounds.gravity.norm();

    Real grid_speed = 0;
    for (Bin& bin : bins_) {
      const Vec3 half = 0.5 * (bin.high - bin.low);
      const Real travel = bounds.time * std::sqrt(3.0) * bin.speed() + fall_ + bounds.stray;
      bin.bound = bin.bound || !clear(bin.low + half, half.norm() + travel);
      if (bin.bound) grid_speed = std::max(grid_speed, bin.speed());
    }
    bounds.reach = std::clamp(std::sqrt(3.0) * bounds.time * grid_speed, bounds.reach, 2.0);
    const Real off = 2 * bounds.stray + bounds.reach + fall_;
    const Real range = std::ceil((kStencil + spread * bounds.time + off) / 4);
    if (range < kMostRange) range_ = static_cast<int>(range);
  }

  std::vector<std::int32_t> run() {
    std::vector<std::int32_t> island(store_.blocks().size(), -1);
    if (range_ == 0) return island;
    join_what_meets();
    list_members();
    fix_what_stays();

    Index leaving = 0;
    std::int32_t count = 0;
    for (std::size_t b = 0; b < island.size(); ++b) {
      const std::int32_t root = groups_.root(static_cast<Index>(b));
      if (bins_[members_[first_[root]]].fixed) continue;
      island[b] = std::size_t(root) == b ? count++ : island[root];
      leaving += store_.blocks()[b].count;
    }
    if (leaving * kWorthwhile < store_.particle_count())
      std::fill(island.begin(), island.end(), -1);
    return island;
  }

 private:
  // False where a particle is not finite.
  bool sort_into_bins(const float* motion, const std::function<bool(const TileRun&)>& may_leave) {
    const std::vector<TileBlock>& blocks = store_.blocks();
    index_.clear(2 * blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b)
      for (int r = 0; r < blocks[b].run_count; ++r) {
        const TileRun& run = store_.runs()[static_cast<std::size_t>(blocks[b].first_run + r)];
        const bool bound = blocks[b].count > kFew || !may_leave(run);
        for (int i = 0; i < run.count; ++i) {
          const std::int32_t t = run.first_tile + i / kLanes;
          const float* lane = store_.tile(t) + i % kLanes;
          const float* moves = motion + std::size_t(t) * kMotionFloats + i % kLanes;
          const Vec3 x =
              4.0 * blocks[b].coord.cast<Real>() + Vec3(lane[0], lane[kLanes], lane[2 * kLanes]);
          const Vec3 v(moves[0], moves[kLanes], moves[2 * kLanes]);
          if (!(x + v).allFinite()) return false;
          Bin& bin = bin_at(((x.array() + 0.5) / 4).floor().cast<int>(), static_cast<Index>(b));
          bin.low = bin.low.cwiseMin(x);
          bin.high = bin.high.cwiseMax(x);
          bin.slow = bin.slow.cwiseMin(v);
          bin.fast = bin.fast.cwiseMax(v);
          bin.bound = bin.bound || bound;
        }
      }
    return true;
  }

  Bin& bin_at(const Vec3i& coord, Index block) {
    const Index fresh = static_cast<Index>(bins_.size());
    const Index at = index_.find_or_add(BlockIndex::key(coord), fresh);
    if (at == fresh) {
      bins_.emplace_back();
      bins_.back().coord = coord;
      bins_.back().block = block;
    } else if (bins_[static_cast<std::size_t>(at)].block != block) {
      groups_.join(bins_[static_cast<std::size_t>(at)].block, block);
    }
    return bins_[static_cast<std::size_t>(at)];
  }

  // Bins near enough to be met; half of them, so that every pair comes once, or all.
  enum class Near { half, all };
  template <class F>
  void each_near(const Bin& bin, Near which, F&& visit) {
    const int side = 2 * range_ + 1, centre = side * side * side / 2;
    for (int k = which == Near::half ? centre + 1 : 0; k <= 2 * centre; ++k) {
      if (k == centre) continue;
      const Vec3i offset(k / (side * side) - range_, k / side % side - range_, k % side - range_);
      const Index at = index_.find(BlockIndex::key(bin.coord + offset));
      if (at >= 0) visit(bins_[static_cast<std::size_t>(at)]);
    }
  }

  // Distance along the best axis that particles keep who stay on their lines. Gravity bends all
  // lines alike.
  Real distance(const Bin& a, const Bin& b) const {
    const Vec3 above = b.low - a.high, below = a.low - b.high;
    const Vec3 rise = b.slow - a.fast, sink = a.slow - b.fast;
    return (above + bounds_.time * rise.cwiseMin(0.0))
        .cwiseMax(below + bounds_.time * sink.cwiseMin(0.0))
        .maxCoeff();
  }
  // Whether a particle that may stray meets matter on the grid, which keeps to its place.
  bool meets_grid(const Bin& a, const Bin& grid) const {
    Bin still = grid;
    still.slow = still.fast = Vec3::Zero();
    return distance(a, still) < kStencil + bounds_.stray + bounds_.reach + fall_;
  }

  // Only those who meet somebody stray.
  void join_what_meets() {
    struct Pair {
      Index a, b;
      Real distance;
    };
    std::vector<Pair> pairs;
    for (std::size_t n = 0; n < bins_.size(); ++n)
      if (!bins_[n].bound)
        each_near(bins_[n], Near::half, [&](const Bin& other) {
          if (other.bound) return;
          const Real apart = distance(bins_[n], other);
          if (apart < kStencil + 2 * bounds_.stray)
            pairs.push_back({bins_[n].block, other.block, apart});
        });
    std::vector<std::int32_t> count(store_.blocks().size(), 0);
    for (std::size_t b = 0; b < count.size(); ++b)
      count[groups_.root(static_cast<Index>(b))] += store_.blocks()[b].count;
    for (bool changed = true; changed;) {
      changed = false;
      for (const Pair& pair : pairs) {
        const std::int32_t a = groups_.root(pair.a), b = groups_.root(pair.b);
        const Real off = bounds_.stray * ((count[a] > 1) + (count[b] > 1));
        if (a == b || !(pair.distance < kStencil + off)) continue;
        groups_.join(a, b);
        count[std::min(a, b)] = count[a] + count[b];
        changed = true;
      }
    }
  }

  void list_members() {
    first_.assign(store_.blocks().size() + 1, 0);
    for (const Bin& bin : bins_) ++first_[groups_.root(bin.block) + 1];
    for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
    members_.resize(bins_.size());
    std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t n = 0; n < bins_.size(); ++n)
      members_[next[groups_.root(bins_[n].block)]++] = static_cast<std::int32_t>(n);
  }

  // Groups that cannot leave, and those that may meet them.
  void fix_what_stays() {
    std::vector<std::int32_t> fresh;
    const auto fix = [&](std::int32_t root) {
      for (std::int32_t m = first_[root]; m < first_[root + 1]; ++m) {
        Bin& bin = bins_[members_[m]];
        if (!bin.fixed) fresh.push_back(members_[m]);
        bin.fixed = true;
      }
    };
    std::vector<Index> count(store_.blocks().size(), 0);
    for (std::size_t b = 0; b < count.size(); ++b)
      count[groups_.root(static_cast<Index>(b))] += store_.blocks()[b].count;
    for (std::size_t root = 0; root < count.size(); ++root) {
      Vec3 low = Vec3::Constant(1e30), high = -low;
      bool stays = false;
      for (std::int32_t m = first_[root]; m < first_[root + 1]; ++m) {
        const Bin& bin = bins_[members_[m]];
        low = low.cwiseMin(bin.low + bounds_.time * bin.slow.cwiseMin(0.0));
        high = high.cwiseMax(bin.high + bounds_.time * bin.fast.cwiseMax(0.0));
        stays = stays || bin.bound;
      }
      // A stencil, the stray and rounding on either side.
      stays = stays || count[root] > most_ || (high - low + Vec3::Constant(8)).prod() > kMostNodes;
      if (stays && count[root] > 0) fix(static_cast<std::int32_t>(root));
    }
    while (!fresh.empty()) {
      const Bin bin = bins_[fresh.back()];
      fresh.pop_back();
      each_near(bin, Near::all, [&](Bin& other) {
        if (!other.fixed && meets_grid(other, bin)) fix(groups_.root(other.block));
      });
    }
  }

  const TileStore& store_;
  LegBounds& bounds_;
  Index most_;  // particles of an island
  Real fall_ = 0;
  int range_ = 0;  // 0: no islands
  BlockIndex index_;
  std::vector<Bin> bins_;
  Groups groups_;
  std::vector<std::int32_t> first_, members_;  // bins of every group, by its root
};

}  // namespace

std::vector<std::int32_t> find_islands(const TileStore& store, const float* motion,
                                       LegBounds& bounds, Index most,
                                       const std::function<bool(const TileRun&)>& may_leave,
                                       const std::function<bool(const Vec3&, Real)>& clear) {
  Index sparse = 0;
  for (const TileBlock& block : store.blocks())
    if (block.count <= kFew) sparse += block.count;
  if (sparse * kWorthwhile < store.particle_count())
    return std::vector<std::int32_t>(store.blocks().size(), -1);
  return Search(store, motion, bounds, most, may_leave, clear).run();
}

}  // namespace rend
