// One block's share of a step: gather from the grid, respond, scatter into the block's own node
// rows.
#if defined(REND_MPM_TILE_PARTICLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MPM_TILE_PARTICLES_INL_H_
#undef REND_MPM_TILE_PARTICLES_INL_H_
#else
#define REND_MPM_TILE_PARTICLES_INL_H_
#endif

#include "engine/mpm/tile_flip-inl.h"
#include "engine/mpm/tile_grid-inl.h"
#include "engine/mpm/tile_material-inl.h"

#include <cstring>

HWY_BEFORE_NAMESPACE();
#if HWY_TARGET != HWY_SCALAR
namespace rend {
namespace HWY_NAMESPACE {

/// Copies the rows of the 8^3 node tile that particles of this block read: velocities, or the part
/// of the grid blocks that begins at `grid` and has `kFloats` a block.
template <int kFloats>
HWY_INLINE void load_nodes(const BlockTask& task, const float* grid, std::uint64_t rows,
                           float* nodes) {
  for (; rows; rows &= rows - 1) {
    const int row = __builtin_ctzll(rows), x = row >> 3, y = row & 7;
    const std::int32_t* z = task.neighbors + 9 * (neighbor_of(x) + 1) + 3 * (neighbor_of(y) + 1);
    const int n = (4 * place_in_neighbor(x) + place_in_neighbor(y)) * kLanes;
    float* to = nodes + row * kNodeRowFloats;
    copy8(grid + std::size_t(z[0]) * kFloats + n + 8, to);
    store_unaligned(load(grid + std::size_t(z[1]) * kFloats + n), to + 8);
    copy8(grid + std::size_t(z[2]) * kFloats + n, to + 24);
  }
}

/// Rows that sparse blocks read; dense ones read all.
HWY_INLINE std::uint64_t rows_to_read(const BlockTask& task, int groups) {
  std::uint64_t rows = 0;
  for (int r = 0; r < task.run_count; ++r) {
    const ParticleRun& run = task.runs[r];
    if (run.count > 2 * kLanes) return ~0ull;
    for (int i = 0; i < run.count; ++i) {
      const float* x = run.tiles + std::size_t(i / kLanes) * groups * kLanes + i % kLanes;
      const auto first = [](float at) HWY_ATTR {
        const float base = __builtin_floorf(at - 0.5f);
        return int(base > -2 ? (base < 3 ? base : 3) : -2) + 2;
      };
      rows |= stencil_rows(64 * first(x[0]) + 8 * first(x[kLanes]));
    }
  }
  return rows;
}

/// A = H + H^2/2 + H^3/6 + H^4/24 of a 3 x 3 matrix: exp(H) - 1, and det(1 + A) > 0 for every H met
/// in a step.
HWY_INLINE void exponential_minus_one(const Lanes* H, Lanes* A) {
  Lanes square[9], tail[9];
  const auto product = [](const Lanes* x, const Lanes* y, Lanes* out) HWY_ATTR {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        out[3 * a + b] =
            mul_add(x[3 * a], y[b], mul_add(x[3 * a + 1], y[3 + b], x[3 * a + 2] * y[6 + b]));
  };
  product(H, H, square);
  for (int i = 0; i < 9; ++i)
    tail[i] = mul_add(square[i], Lanes(1.0f / 24), H[i] * Lanes(1.0f / 6));
  for (int i = 0; i < 9; i += 4) tail[i] += Lanes(0.5f);
  product(square, tail, A);
  for (int i = 0; i < 9; ++i) A[i] += H[i];
}

/// Trial strain b - 1 <- (1 + A)(b)(1 + A)^T - 1, formed from b - 1 so that small strains keep
/// their digits.
HWY_INLINE void push_forward(const Lanes* A, Lanes* e) {
  Lanes g[9];
  for (int a = 0; a < 3; ++a) {
    const Lanes* h = A + 3 * a;
    g[3 * a] = mul_add(h[0], e[0], mul_add(h[1], e[3], mul_add(h[2], e[5], h[0])));
    g[3 * a + 1] = mul_add(h[0], e[3], mul_add(h[1], e[1], mul_add(h[2], e[4], h[1])));
    g[3 * a + 2] = mul_add(h[0], e[5], mul_add(h[1], e[4], mul_add(h[2], e[2], h[2])));
  }
  constexpr int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  for (int i = 0; i < 6; ++i) {
    const int a = row[i], b = column[i];
    const Lanes twice = mul_add(g[3 * a], A[3 * b],
                                mul_add(g[3 * a + 1], A[3 * b + 1], g[3 * a + 2] * A[3 * b + 2]));
    e[i] += g[3 * a + b] + g[3 * b + a] + twice;
  }
}

/// H <- H - W^2 / 2 with W the skew part of H, see step_exponent().
HWY_INLINE void follow_rotation(Lanes* H) {
  const Lanes half(0.5f);
  const Lanes w[3] = {half * (H[7] - H[5]), half * (H[2] - H[6]), half * (H[3] - H[1])};
  const Lanes h[3] = {half * w[0], half * w[1], half * w[2]};
  H[0] = mul_add(h[1], w[1], mul_add(h[2], w[2], H[0]));
  H[4] = mul_add(h[2], w[2], mul_add(h[0], w[0], H[4]));
  H[8] = mul_add(h[0], w[0], mul_add(h[1], w[1], H[8]));
  constexpr int upper[3] = {1, 5, 6}, lower[3] = {3, 7, 2};
  for (int a = 0; a < 3; ++a) {
    const Lanes off = h[a] * w[(a + 1) % 3];
    H[upper[a]] = H[upper[a]] - off;
    H[lower[a]] = H[lower[a]] - off;
  }
}

/// b^e - I of a tile after a step dt with velocity gradient C.
HWY_INLINE void push_strain(Lanes dt, const Lanes* C, float* tile) {
  Lanes H[9], A[9], e[6];
  for (int i = 0; i < 9; ++i) H[i] = dt * C[i];
  follow_rotation(H);
  exponential_minus_one(H, A);
  load_strain(tile, e);
  push_forward(A, e);
  for (int i = 0; i < 6; ++i) store(e[i], tile + (TileLayout::kStrain + i) * kLanes);
}

inline constexpr float kNoExcess = -8;

constexpr bool gathers(Pass pass) { return pass != Pass::scatter && pass != Pass::mesh_scatter; }
constexpr bool scatters(Pass pass) { return pass != Pass::gather && pass != Pass::mesh_gather; }
constexpr bool meets_mesh(Pass pass) {
  return pass == Pass::mesh_scatter || pass == Pass::mesh_gather;
}

/// Extremes that a pass collects, lane by lane.
struct LaneExtremes {
  Lanes excess, speed2, gradient2;
  LaneMask finite;

  HWY_INLINE LaneExtremes()
      : excess(kNoExcess), speed2(0.0f), gradient2(0.0f), finite(Lanes(0.0f) < Lanes(1.0f)) {}
  HWY_INLINE void add(const Lanes* v, const Lanes* C) {
    const Lanes v2 = mul_add(v[0], v[0], mul_add(v[1], v[1], v[2] * v[2]));
    Lanes C2 = C[0] * C[0];
    for (int i = 1; i < 9; ++i) C2 = mul_add(C[i], C[i], C2);
    speed2 = max(speed2, v2);
    gradient2 = max(gradient2, C2);
    finite = finite & (v2 + C2 < Lanes(1e30f));
  }
  /// Of a motion at another velocity than the one that particles carry.
  HWY_INLINE void add_speed(const Lanes* v) {
    speed2 = max(speed2, mul_add(v[0], v[0], mul_add(v[1], v[1], v[2] * v[2])));
  }
  HWY_INLINE void reduce(RunExtremes& run) const {
    run.speed2 = max_of_lanes(speed2);
    run.gradient2 = max_of_lanes(gradient2);
    run.finite = !any(!finite);
  }
  HWY_INLINE void reduce(BlockTask& task, RunExtremes& run) const {
    const float farthest = max_of_lanes(excess);
    if (farthest > task.excess) task.excess = farthest;
    reduce(run);
  }
};

/// The affine velocity that particles carry on: keep C + swap C^T.
HWY_INLINE void store_carried(const StepConstants& step, const Lanes* C, float* motion) {
  const Lanes keep(step.affine_keep), swap(step.affine_swap);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      store(mul_add(swap, C[3 * b + a], keep * C[3 * a + b]), motion + (3 + 3 * a + b) * kLanes);
}

/// The position of vertices of elements is kept to twice the digits, high + low with low where
/// others keep their strain: elements see differences of positions, again and again.
HWY_INLINE void move_vertices(Lanes dt, const Lanes* v, float* tile) {
  for (int a = 0; a < 3; ++a) {
    float* high = tile + (TileLayout::kPosition + a) * kLanes;
    float* low = tile + (TileLayout::kStrain + a) * kLanes;
    const Lanes before = load(high), step = mul_add(dt, v[a], load(low));
    const Lanes after = before + step;
    store(after, high);
    store(step - (after - before), low);
  }
}

/// After the gather: moves the particles, pushes the strain forward, keeps v, without the common
/// velocity, and C in work.
template <Pass kPass, bool kFlip>
HWY_INLINE void move_tile(const StepConstants& step, const BlockTask& task, bool on_mesh,
                          float* tile, float* motion, int t, WorkOf<kFlip>& work,
                          LaneExtremes& extremes) {
  Lanes relative[4], G[3][4], x[3], offset[3], C[9], v[3];
  transpose_gathered(work.gathered[t], relative, G);
  for (int a = 0; a < 3; ++a) offset[a] = load(work.offset[t][a]);
  for (int b = 0; b < 3; ++b)
    for (int a = 0; a < 3; ++a)
      C[3 * a + b] = Lanes(4.0f) * neg_mul_add(offset[b], relative[a], G[b][a]);
  for (int a = 0; a < 3; ++a) v[a] = relative[a] + Lanes(step.common_velocity[a]);
  const Lanes dt(step.dt);
  if (meets_mesh(kPass) && on_mesh) move_vertices(dt, v, tile);
  for (int a = 0; a < 3; ++a) {
    float* place = tile + (TileLayout::kPosition + a) * kLanes;
    if (meets_mesh(kPass) && on_mesh) {
      x[a] = load(place);
    } else {
      x[a] = mul_add(dt, v[a], load(place));
      store(x[a], place);
    }
    extremes.excess =
        max(extremes.excess, max(x[a] - Lanes(task.high[a]), Lanes(task.low[a]) - x[a]));
  }
  if constexpr (kFlip) {
    extremes.add_speed(v);
    blend_flip(step.flip_ratio, work.changes[t], tile + step.layout.velocity * kLanes, v);
    for (int a = 0; a < 3; ++a) relative[a] = v[a] - Lanes(step.common_velocity[a]);
  }
  extremes.add(v, C);
  if (!(meets_mesh(kPass) && on_mesh)) push_strain(dt, C, tile);
  if constexpr (kPass == Pass::fused) {
    for (int a = 0; a < 3; ++a) store(relative[a], work.v[t][a]);
    if constexpr (!kFlip)
      for (int i = 0; i < 9; ++i) store(C[i], work.C[t][i]);
    stencil_weights<Transfers::scatter>(x, offset, work.weights[t]);
    for (int a = 0; a < 3; ++a) store(offset[a], work.offset[t][a]);
  } else {
    for (int a = 0; a < 3; ++a) store(v[a], motion + a * kLanes);
    store_carried(step, C, motion);
  }
}

/// Momentum, without the common velocity, of sixteen particles with its affine part and the impulse
/// of the stress until the next grid step.
HWY_INLINE void pack_tile(const StepConstants& step, float density, const float* tile, int t,
                          Work& work) {
  Lanes v[3], offset[3], A[9];
  for (int a = 0; a < 3; ++a) {
    v[a] = load(work.v[t][a]);
    offset[a] = load(work.offset[t][a]);
  }
  const Lanes V = abs(load(tile + TileLayout::kVolume * kLanes));
  const Lanes mass = Lanes(density) * V, impulse = Lanes(step.stress_factor) * V;
  const Lanes keep = mass * Lanes(step.affine_keep), swap = mass * Lanes(step.affine_swap);
  constexpr int symmetric[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
  for (int i = 0; i < 9; ++i)
    A[i] = mul_add(impulse, load(work.stress[t][symmetric[i]]), keep * load(work.C[t][i]));
  if (step.affine_swap != 0)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        A[3 * a + b] = mul_add(swap, load(work.C[t][3 * b + a]), A[3 * a + b]);
  pack_momentum(mass, v, A, offset, work.momentum[t]);
}

/// Moves the touched rows together into the block's own memory, `kStride` floats apart.
template <int kStride>
HWY_INLINE void store_rows(const float* nodes, std::uint64_t touched, float* to) {
  for (std::uint64_t m = touched; m; m &= m - 1, to += kStride) {
    const float* from = nodes + __builtin_ctzll(m) * kNodeRowFloats;
    store(load(from), to);
    store(load(from + 16), to + 16);
  }
}

/// Weights of the positions in a tile as they are now.
template <Transfers kFor>
HWY_INLINE void weigh_tile(const float* tile, int t, Work& work) {
  const Lanes x[3] = {load(tile), load(tile + kLanes), load(tile + 2 * kLanes)};
  Lanes offset[3];
  stencil_weights<kFor>(x, offset, work.weights[t]);
  for (int a = 0; a < 3; ++a) store(offset[a], work.offset[t][a]);
}

HWY_INLINE void load_motion(const StepConstants& step, const float* motion, int t, Work& work) {
  for (int a = 0; a < 3; ++a)
    store(load(motion + a * kLanes) - Lanes(step.common_velocity[a]), work.v[t][a]);
  for (int i = 0; i < 9; ++i) store(load(motion + (3 + i) * kLanes), work.C[t][i]);
}

HWY_INLINE void no_stress(int tiles, Work& work) {
  for (int t = 0; t < tiles; ++t)
    for (int i = 0; i < 6; ++i) store(Lanes(0.0f), work.stress[t][i]);
}

template <Pass kPass, bool kFlip>
HWY_NOINLINE void particle_block(const StepConstants& step, BlockTask& task) {
  const FlushDenormals flush;
  static thread_local WorkOf<kFlip> work;
  const int tile_floats = step.layout.floats();
  constexpr int kGridFloats = kGridBlockFloats * parts_of_node(kFlip);
  constexpr int kRowFloats = kNodeRowFloats * parts_of_node(kFlip);
  if constexpr (gathers(kPass)) {
    const std::uint64_t rows = rows_to_read(task, step.layout.groups);
    load_nodes<kGridFloats>(task, task.grid, rows, work.velocity);
    if constexpr (kFlip)
      load_nodes<kGridFloats>(task, task.grid + kGridBlockFloats, rows, work.change);
  }
  task.touched = 0;
  task.excess = kNoExcess;
  for (int r = 0; r < task.run_count; ++r) {
    const ParticleRun& run = task.runs[r];
    const MaterialConstants& material = *run.material;
    RunExtremes& out = task.extremes[r];
    out = RunExtremes{};
    LaneExtremes extremes;
    for (int first = 0; first < run.count; first += kBatch * kLanes) {
      const int count = run.count - first < kBatch * kLanes ? run.count - first : kBatch * kLanes;
      const int tiles = (count + kLanes - 1) / kLanes;
      float* const begin = run.tiles + std::size_t(first / kLanes) * tile_floats;
      float* const motion = run.motion + std::size_t(first / kLanes) * kMotionFloats;
      constexpr Transfers kFirst = gathers(kPass) ? Transfers::gather : Transfers::scatter;
      for (int t = 0; t < tiles; ++t) weigh_tile<kFirst>(begin + t * tile_floats, t, work);
      if constexpr (!gathers(kPass)) {
        for (int t = 0; t < tiles; ++t) {
          load_motion(step, motion + t * kMotionFloats, t, work);
          if constexpr (kFlip)
            keep_velocity(motion + t * kMotionFloats, count - t * kLanes,
                          begin + t * tile_floats + step.layout.velocity * kLanes);
        }
        if (meets_mesh(kPass) && material.on_mesh)
          no_stress(tiles, work);
        else
          stress_batch(material, step.layout, begin, tiles, work);
      } else {
        for (int t = 0; t < tiles; ++t) {
          const int lanes = count - t * kLanes < kLanes ? count - t * kLanes : kLanes;
          gather_tile(work.velocity, work.weights[t], lanes, work.gathered[t]);
          if constexpr (kFlip) gather_changes(work.change, work.weights[t], lanes, work.changes[t]);
        }
        for (int t = 0; t < tiles; ++t)
          move_tile<kPass, kFlip>(step, task, material.on_mesh, begin + t * tile_floats,
                                  motion + t * kMotionFloats, t, work, extremes);
        if (!(meets_mesh(kPass) && material.on_mesh))
          respond_function(material.response)(material, step.layout, begin, tiles, work, out);
      }
      if constexpr (scatters(kPass)) {
        for (int t = 0; t < tiles; ++t) {
          const float* tile = begin + t * tile_floats;
          if constexpr (kFlip)
            pack_flip(step, material.density, tile, kPass != Pass::fused, t, work);
          else
            pack_tile(step, material.density, tile, t, work);
        }
        if constexpr (kFlip) {
          std::uint64_t touched = task.touched;
          scatter_batch(work.weights, work.impulse_of, count, work.impulse, touched);
        }
        scatter_batch<!kFlip>(work.weights, work.momentum, count, work.nodes, task.touched);
      }
    }
    if constexpr (gathers(kPass)) extremes.reduce(task, out);
  }
  task.touched &=
      task.allowed;  // all of it, unless a particle ran past the guard, which the excess tells
  if constexpr (scatters(kPass)) {
    store_rows<kRowFloats>(work.nodes, task.touched, task.rows);
    if constexpr (kFlip)
      store_rows<kRowFloats>(work.impulse, task.touched, task.rows + kNodeRowFloats);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
#endif
HWY_AFTER_NAMESPACE();
#endif  // include toggle
