// Grid step of one block of nodes: ordered sum over particle blocks, velocities, gravity.
#if defined(REND_MPM_TILE_GRID_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MPM_TILE_GRID_INL_H_
#undef REND_MPM_TILE_GRID_INL_H_
#else
#define REND_MPM_TILE_GRID_INL_H_
#endif

#include "engine/mpm/tile_transfer-inl.h"

HWY_BEFORE_NAMESPACE();
#if HWY_TARGET != HWY_SCALAR
namespace rend {
namespace HWY_NAMESPACE {

/// Neighbor of a block, -1, 0 or 1 along one axis, that tile node t = 0..7 lies in, and the node's
/// place there.
constexpr int neighbor_of(int t) { return (t + 2) / 4 - 1; }
constexpr int place_in_neighbor(int t) { return (t + 2) % 4; }

/// Rows of a particle block's 8 x 8 that lie in its neighbor with x and y offsets k / 3 - 1 and k %
/// 3 - 1.
struct NeighborRows {
  std::uint64_t of[9] = {};
  constexpr NeighborRows() {
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y)
        of[3 * (neighbor_of(x) + 1) + neighbor_of(y) + 1] |= 1ull << (8 * x + y);
  }
};
static constexpr NeighborRows kNeighborRows;

/// Adds the part of a tile row that lies in the neighbor with z offset oz to that neighbor's row of
/// four nodes.
HWY_INLINE void add_row(int oz, const float* row, float* to) {
  if (oz == 0) {
    store(load(to) + load_unaligned(row + 8), to);
  } else if (oz < 0) {
    add8(row, to + 8);
  } else {
    add8(row + 24, to);
  }
}

/// v = p / m + dt g on every touched row, with FLIP (p + J) / m + dt g and J / m + dt g, p and v
/// without the common velocity; the sums run over particle blocks in the order of `sources`.
template <bool kFlip>
HWY_NOINLINE void grid_block(GridTask& task) {
  const FlushDenormals flush;
  constexpr int kFloats = kGridBlockFloats * parts_of_node(kFlip);
  alignas(64) float sum[kFloats];
  for (int i = 0; i < kFloats; i += 16) store(Lanes(0.0f), sum + i);
  std::uint32_t touched = 0;
  for (int s = 0; s < task.source_count; ++s) {
    const RowSource& source = task.sources[s];
    const RowsOfBlock& block = task.blocks[source.block];
    const int oz = source.neighbor % 3 - 1;
    for (std::uint64_t m = block.touched & kNeighborRows.of[source.neighbor / 3]; m; m &= m - 1) {
      const int row = __builtin_ctzll(m);
      const int rank = __builtin_popcountll(block.touched & ((m & (~m + 1)) - 1));
      const int place = 4 * place_in_neighbor(row >> 3) + place_in_neighbor(row & 7);
      touched |= 1u << place;
      const float* from = block.rows + rank * kNodeRowFloats * parts_of_node(kFlip);
      add_row(oz, from, sum + place * kLanes);
      if constexpr (kFlip)
        add_row(oz, from + kNodeRowFloats, sum + kGridBlockFloats + place * kLanes);
    }
  }
  const Lanes gain = repeat4(task.velocity_gain), common = repeat4(task.common_velocity);
  Lanes fastest(0.0f);
  for (std::uint32_t m = touched; m; m &= m - 1) {
    const int place = __builtin_ctz(m);
    const Lanes node = load(sum + place * kLanes);
    Lanes velocity;
    if constexpr (kFlip) {
      const Lanes mass = max(last_of_four(node), Lanes(1e-20f));
      const Lanes change = load(sum + kGridBlockFloats + place * kLanes) / mass + gain;
      store(change, task.nodes + kGridBlockFloats + place * kLanes);
      velocity = node / mass + change;
    } else {
      velocity = node / max(last_of_four(node), Lanes(1e-20f)) + gain;
    }
    fastest = max(fastest, replace_last_of_four(abs(velocity + common), Lanes(0.0f)));
    store(replace_last_of_four(velocity, node), task.nodes + place * kLanes);
  }
  task.touched = touched;
  task.max_speed = max_of_lanes(fastest);
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
#endif
HWY_AFTER_NAMESPACE();
#endif  // include toggle
