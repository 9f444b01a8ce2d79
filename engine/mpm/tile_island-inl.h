// The grid step of islands: particles that share nodes among themselves only, on nodes of their own
// that stay in the cache.
#if defined(REND_MPM_TILE_ISLAND_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MPM_TILE_ISLAND_INL_H_
#undef REND_MPM_TILE_ISLAND_INL_H_
#else
#define REND_MPM_TILE_ISLAND_INL_H_
#endif

#include "engine/mpm/tile_lone-inl.h"

HWY_BEFORE_NAMESPACE();
#if HWY_TARGET != HWY_SCALAR
namespace rend {
namespace HWY_NAMESPACE {

/// What a tile hands from stage to stage.
struct alignas(64) IslandWork {
  Weights weights;
  Momentum momentum;
  float gathered[16][16];
  float rows[9 * 16];
};

/// Whether the stencil of a lane begins at a node of the task: a ghost's need not, and no other
/// position, not even NaN, may write outside.
HWY_INLINE bool is_here(const IslandTask& task, std::int32_t base) {
  return std::uint32_t(base) < std::uint32_t(task.node_count);
}
HWY_INLINE float* stencil_of(const IslandTask& task, const IslandTask::Tile& tile, int l) {
  return task.nodes + std::size_t(tile.base[l]) * 4;
}

HWY_INLINE void load_place(const float* particles, Lanes* x, Lanes* base) {
  for (int a = 0; a < 3; ++a) {
    x[a] = load(particles + (TileLayout::kPosition + a) * kLanes);
    base[a] = floor(x[a] - Lanes(0.5f));
  }
}

/// First nodes and strides of sixteen stencils.
HWY_INLINE void place_tile(const IslandTask& task, IslandTask::Tile& tile) {
  const IslandLanes& lanes = *tile.lanes;
  Lanes x[3], base[3];
  load_place(tile.particles, x, base);
  const Lanes sx = load(lanes.stride_x), sy = load(lanes.stride_y);
  const Lanes origin = load(lanes.origin) - Lanes(float(task.first_node));
  store_int(mul_add(base[0], sx, mul_add(base[1], sy, base[2] + origin)), tile.base);
  store_int(sx, tile.stride_x);
  store_int(sy, tile.stride_y);
}

HWY_INLINE void clear_nodes(const IslandTask& task, const IslandTask::Tile& tile) {
  for (int l = 0; l < tile.count; ++l) {
    if (!is_here(task, tile.base[l])) continue;
    float* first = stencil_of(task, tile, l);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        store_unaligned(Lanes(0.0f), first + 4 * (i * tile.stride_x[l] + j * tile.stride_y[l]));
  }
}

/// Adds w m (v + C (x_i - x_p)) and w m of a tile to its nodes; particles that follow each other in
/// one cell share their sums.
HWY_INLINE void scatter_island(const IslandTask& task, const IslandTask::Tile& tile,
                               IslandWork& work) {
  Lanes x[3], base[3], offset[3], v[3], A[9];
  load_place(tile.particles, x, base);
  spline_weights<Transfers::scatter>(x, base, offset, work.weights);
  const Lanes mass = Lanes(tile.density) * abs(load(tile.particles + TileLayout::kVolume * kLanes));
  for (int a = 0; a < 3; ++a) v[a] = load(tile.motion + a * kLanes);
  for (int i = 0; i < 9; ++i) A[i] = mass * load(tile.motion + (3 + i) * kLanes);
  pack_momentum(mass, v, A, offset, work.momentum);
  for (int part = 0; part < kParts; ++part) {
    const PartVec z_index = part_index(part);
    StencilSums sums;
    sums.clear();
    for (int l = 0; l < tile.count; ++l) {
      if (!is_here(task, tile.base[l])) continue;
      sums.add<true>(work.weights, work.momentum, l, part, z_index);
      if (l + 1 < tile.count && tile.base[l + 1] == tile.base[l]) continue;
      sums.add_to(stencil_of(task, tile, l) + part * kPart, 4 * tile.stride_x[l],
                  4 * tile.stride_y[l]);
      sums.clear();
    }
  }
}

/// v and C of a tile from the velocities p / m of its nodes.
HWY_INLINE void gather_island(const IslandTask& task, const IslandTask::Tile& tile,
                              IslandWork& work, Lanes& strayed) {
  Lanes x[3], base[3], offset[3], v[4], G[3][4];
  load_place(tile.particles, x, base);
  spline_weights<Transfers::gather>(x, base, offset, work.weights);
  const Lanes z_index = group_index() - Lanes(1.0f);
  std::int32_t before = -1;
  for (int l = 0; l < 16; ++l) {
    if (l >= tile.count || !is_here(task, tile.base[l])) {
      store(l > 0 ? load(work.gathered[l - 1]) : Lanes(0.0f), work.gathered[l]);
      continue;
    }
    if (tile.base[l] != before) {
      before = tile.base[l];
      const float* first = stencil_of(task, tile, l);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const Lanes node =
              load_unaligned(first + 4 * (i * tile.stride_x[l] + j * tile.stride_y[l]));
          store(node / max(last_of_four(node), Lanes(1e-20f)), work.rows + (3 * i + j) * 16);
        }
    }
    const auto row = [&](int i, int j) HWY_ATTR { return load(work.rows + (3 * i + j) * 16); };
    store(gather_particle(row, work.weights, l, z_index), work.gathered[l]);
  }
  transpose_gathered(work.gathered, v, G);
  for (int a = 0; a < 3; ++a) {
    const Lanes straight = load(tile.lanes->velocity[a]) + Lanes(task.fall[a]);
    strayed = max(strayed, abs(v[a] - straight));
    store(v[a], tile.out + a * kLanes);
  }
  for (int b = 0; b < 3; ++b)
    for (int a = 0; a < 3; ++a)
      store(Lanes(4.0f) * neg_mul_add(offset[b], v[a], G[b][a]),
            tile.out + (3 + 3 * a + b) * kLanes);
}

/// From v and the kicked C that `lone_run` left to v and C after the nodes' step but for gravity.
HWY_NOINLINE void exchange_islands(IslandTask& task) {
  const FlushDenormals flush;
  static thread_local IslandWork work;
  for (std::int32_t t = 0; t < task.tile_count; ++t) {
    place_tile(task, task.tiles[t]);
    clear_nodes(task, task.tiles[t]);
  }
  for (std::int32_t t = 0; t < task.tile_count; ++t) scatter_island(task, task.tiles[t], work);
  Lanes strayed(0.0f);
  for (std::int32_t t = 0; t < task.tile_count; ++t)
    if (task.tiles[t].out) gather_island(task, task.tiles[t], work, strayed);
  task.strayed = max_of_lanes(strayed);
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
#endif
HWY_AFTER_NAMESPACE();
#endif  // include toggle
