// Transfers between particles and node rows: sixteen particles for weights, sixteen node values for
// sums.
#if defined(REND_MPM_TILE_TRANSFER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MPM_TILE_TRANSFER_INL_H_
#undef REND_MPM_TILE_TRANSFER_INL_H_
#else
#define REND_MPM_TILE_TRANSFER_INL_H_
#endif

#include "engine/core/lanes-inl.h"
#include "engine/mpm/tile_kernel.h"

HWY_BEFORE_NAMESPACE();
#if HWY_TARGET != HWY_SCALAR
namespace rend {
namespace HWY_NAMESPACE {

/// Rounds denormal numbers to 0 while it lives: they cost a hundred times a normal one on some
/// CPUs, and setting it in every kernel keeps results independent of the thread that runs it.
class FlushDenormals {
 public:
#if HWY_ARCH_X86
  HWY_INLINE FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  HWY_INLINE ~FlushDenormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#endif
};

/// Tiles that go through a stage together.
inline constexpr int kBatch = 4;
/// Node rows of a tile: 8 x 8, x major.
inline constexpr int kPlane = 8 * kNodeRowFloats;

/// Quadratic B-spline weights of sixteen particles. Four z weights (the last is 0) lie together,
/// particle l at wz[l & 3][l >> 2], as a 4 x 4 transpose leaves them.
struct alignas(64) Weights {
  float wx[3][16], wy[3][16];  ///< for the gather
  float wxy[9][16];            ///< products, for the scatter
  float wz[4][4][4];
  std::int32_t base[16];  ///< first node of the stencil, 64 x + 8 y + z in the tile
};

/// Momentum and its gradient per particle, in the same transposed order: rows p, A e_x, A e_y, A
/// e_z.
struct alignas(64) Momentum {
  float row[4][4][4][4];

  HWY_INLINE const float* of(int r, int lane) const { return row[r][lane & 3][lane >> 2]; }
};

/// Everything a batch of tiles hands from stage to stage; stays in the first-level cache.
struct alignas(64) Work {
  float velocity[kNodeTileFloats];
  float nodes[kNodeTileFloats];
  Weights weights[kBatch];
  Momentum momentum[kBatch];
  float gathered[kBatch][16][16];  ///< per particle: v, then its x, y, z moments, 4 floats each
  float offset[kBatch][3][16];     ///< x - centre node of the stencil
  float v[kBatch][3][16];
  float C[kBatch][9][16];
  float stress[kBatch][6][16];
};

enum class Transfers { gather, scatter, both };

/// Weights of N(x) on the stencils that begin at `base`, and the offset from the centre node.
template <Transfers kFor>
HWY_INLINE void spline_weights(const Lanes* x, const Lanes* base, Lanes* offset, Weights& w) {
  const Lanes half(0.5f);
  Lanes n[3][3];
  for (int a = 0; a < 3; ++a) {
    const Lanes f = x[a] - base[a];
    const Lanes left = Lanes(1.5f) - f, right = f - half;
    offset[a] = f - Lanes(1.0f);
    n[a][0] = half * left * left;
    n[a][1] = neg_mul_add(offset[a], offset[a], Lanes(0.75f));
    n[a][2] = half * right * right;
  }
  if constexpr (kFor != Transfers::scatter)
    for (int i = 0; i < 3; ++i) {
      store(n[0][i], w.wx[i]);
      store(n[1][i], w.wy[i]);
    }
  if constexpr (kFor != Transfers::gather)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) store(n[0][i] * n[1][j], w.wxy[3 * i + j]);
  Lanes z[4];
  transpose4(n[2][0], n[2][1], n[2][2], Lanes(0.0f), z);
  for (int r = 0; r < 4; ++r) store(z[r], &w.wz[r][0][0]);
}

/// The same on the tile of a block. The base is clamped to the tile, so that no position, not even
/// NaN, can write outside it.
template <Transfers kFor>
HWY_INLINE void stencil_weights(const Lanes* x, Lanes* offset, Weights& w) {
  Lanes base[3];
  for (int a = 0; a < 3; ++a)
    base[a] = min(max(floor(x[a] - Lanes(0.5f)), Lanes(-2.0f)), Lanes(3.0f));
  store_int(mul_add(base[0], Lanes(64.0f), mul_add(base[1], Lanes(8.0f), base[2])) +
                Lanes(2.0f * 64 + 2 * 8 + 2),
            w.base);
  spline_weights<kFor>(x, base, offset, w);
}

/// Rows of the 8 x 8 that the stencil with this base covers.
HWY_INLINE std::uint64_t stencil_rows(std::int32_t base) { return 0x070707ull << (base >> 3); }

/// Gathers sum w v and sum w v (x_i - centre) of one particle from the rows row(i, j) of its
/// stencil: sums over y and x factor out.
template <class Rows>
HWY_INLINE Lanes gather_particle(const Rows& row, const Weights& w, int lane, Lanes z_index) {
  const Lanes wz = spread4(w.wz[lane & 3][lane >> 2]);
  const Lanes y0(w.wy[0][lane]), y1(w.wy[1][lane]), y2(w.wy[2][lane]);
  Lanes sum, sum_x, sum_y, first;
  for (int i = 0; i < 3; ++i) {
    const Lanes p0 = y0 * row(i, 0);
    const Lanes row2 = row(i, 2);
    const Lanes plane = mul_add(y2, row2, mul_add(y1, row(i, 1), p0));
    const Lanes plane_y = mul_sub(y2, row2, p0);
    const Lanes x(w.wx[i][lane]);
    if (i == 0) {
      first = sum = x * plane;
      sum_y = x * plane_y;
    } else {
      if (i == 2) sum_x = mul_sub(x, plane, first);
      sum = mul_add(x, plane, sum);
      sum_y = mul_add(x, plane_y, sum_y);
    }
  }
  sum = sum * wz;
  return sum_groups(sum, sum_x * wz, sum_y * wz, sum * z_index);
}

/// Gathers a whole tile into `out`, one particle a row; pad lanes follow the last particle.
HWY_INLINE void gather_tile(const float* nodes, const Weights& w, int count, float out[16][16]) {
  const Lanes z_index = group_index() - Lanes(1.0f);
  for (int l = 0; l < count; ++l) {
    const float* first = nodes + std::size_t(w.base[l]) * 4;
    const auto row = [&](int i, int j) HWY_ATTR {
      return load_unaligned(first + i * kPlane + j * kNodeRowFloats);
    };
    store(gather_particle(row, w, l, z_index), out[l]);
  }
  for (int l = count; l < 16; ++l) store(load(out[count - 1]), out[l]);
}

/// From one particle a row to one quantity a vector: v, and G[axis] = sum w v (x_i - centre)_axis.
HWY_INLINE void transpose_gathered(const float rows[16][16], Lanes* v, Lanes G[3][4]) {
  for (int q = 0; q < 4; ++q) {
    Lanes part[4];
    for (int r = 0; r < 4; ++r)
      part[r] =
          concat4(&rows[r][4 * q], &rows[4 + r][4 * q], &rows[8 + r][4 * q], &rows[12 + r][4 * q]);
    transpose4(part[0], part[1], part[2], part[3], q == 0 ? v : G[q - 1]);
  }
}

/// Momentum about the centre node, p = m v - A offset, and A, ready for scatter_batch.
HWY_INLINE void pack_momentum(Lanes mass, const Lanes* v, const Lanes* A, const Lanes* offset,
                              Momentum& out) {
  Lanes p[3], t[4];
  for (int a = 0; a < 3; ++a)
    p[a] = mul_sub(
        mass, v[a],
        mul_add(A[3 * a], offset[0], mul_add(A[3 * a + 1], offset[1], A[3 * a + 2] * offset[2])));
  transpose4(p[0], p[1], p[2], mass, t);
  for (int r = 0; r < 4; ++r) store(t[r], &out.row[0][r][0][0]);
  for (int q = 0; q < 3; ++q) {
    transpose4(A[q], A[3 + q], A[6 + q], Lanes(0.0f), t);
    for (int r = 0; r < 4; ++r) store(t[r], &out.row[1 + q][r][0][0]);
  }
}

/// With 128-bit vectors a row of four nodes goes through the scatter node by node, so that the nine
/// row sums stay in registers; the fourth node is left out because its weight is 0. Wider vectors
/// keep the row together: AVX2 and AVX-512 must add to a node in the same order.
inline constexpr size_t kPart = kLeaf == 4 ? 4 : 16;
inline constexpr int kParts = kLeaf == 4 ? 3 : 1;
using PartVec = WideVec<kPart>;

/// The place along z of the nodes in a part of a row, -1, 0 or 1 from the centre.
HWY_INLINE PartVec part_index(int part) {
  return wide_load<kPart>(kGroupIndex + part * kPart) - wide_set<kPart>(1.0f);
}

/// Nine row accumulators of the stencil that consecutive particles share.
struct StencilSums {
  PartVec row[3][3];

  HWY_INLINE void clear() {
    for (auto& plane : row)
      for (PartVec& r : plane) r = wide_set<kPart>(0.0f);
  }
  /// Adds part `part` of w (p + A (x_i - centre)) and w m of one particle; without `kAffine` w p and
  /// w m.
  template <bool kAffine>
  HWY_INLINE void add(const Weights& w, const Momentum& m, int l, int part, PartVec z_index) {
    const PartVec wz = spread_part(w.wz[l & 3][l >> 2], part);
    const auto add_node = [&](int i, int j, PartVec node) HWY_ATTR {
      row[i][j] = wide_mul_add(wide_set<kPart>(w.wxy[3 * i + j][l]), node, row[i][j]);
    };
    if constexpr (kAffine) {
      const PartVec X = wide_repeat4<kPart>(m.of(1, l)) * wz;
      const PartVec Y = wide_repeat4<kPart>(m.of(2, l)) * wz;
      const PartVec centre = wide_mul_add(wide_repeat4<kPart>(m.of(3, l)), z_index,
                                          wide_repeat4<kPart>(m.of(0, l))) *
                             wz;
      for (int i = 0; i < 3; ++i) {
        const PartVec plane = i == 0 ? centre - X : i == 1 ? centre : centre + X;
        add_node(i, 0, plane - Y);
        add_node(i, 1, plane);
        add_node(i, 2, plane + Y);
      }
    } else {
      const PartVec node = wide_repeat4<kPart>(m.of(0, l)) * wz;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) add_node(i, j, node);
    }
  }
  /// Adds the sums to the nodes from `first` on, rows being so many floats apart along x and y.
  HWY_INLINE void add_to(float* first, std::ptrdiff_t along_x, std::ptrdiff_t along_y) const {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        float* r = first + i * along_x + j * along_y;
        wide_store_unaligned<kPart>(wide_load_unaligned<kPart>(r) + row[i][j], r);
      }
  }
  /// Adds the sums to the tile; rows touched for the first time are cleared.
  HWY_INLINE void flush(float* nodes, int part, std::int32_t base, std::uint64_t& touched) const {
    std::uint64_t fresh = stencil_rows(base) & ~touched;
    touched |= fresh;
    for (; fresh; fresh &= fresh - 1) {
      float* r = nodes + __builtin_ctzll(fresh) * kNodeRowFloats;
      store(Lanes(0.0f), r);
      store(Lanes(0.0f), r + 16);
    }
    add_to(nodes + std::size_t(base) * 4 + part * kPart, kPlane, kNodeRowFloats);
  }
};

/// Scatters part `part` of w (p + A (x_i - centre)) and w m of a batch of tiles holding `count`
/// particles; without `kAffine` w p and w m.
template <bool kAffine>
HWY_INLINE void scatter_part(const Weights* weights, const Momentum* momentum, int count, int part,
                             float* nodes, std::uint64_t& touched) {
  const PartVec z_index = part_index(part);
  StencilSums sums;
  sums.clear();
  std::int32_t base = weights[0].base[0];
  for (int first = 0; first < count; first += 16) {
    const Weights& w = weights[first / 16];
    const int lanes = count - first < 16 ? count - first : 16;
    for (int l = 0; l < lanes; ++l) {
      if (w.base[l] != base) {
        sums.flush(nodes, part, base, touched);
        base = w.base[l];
        sums.clear();
      }
      sums.add<kAffine>(w, momentum[first / 16], l, part, z_index);
    }
  }
  sums.flush(nodes, part, base, touched);
}

template <bool kAffine = true>
HWY_INLINE void scatter_batch(const Weights* weights, const Momentum* momentum, int count,
                              float* nodes, std::uint64_t& touched) {
  for (int part = 0; part < kParts; ++part)
    scatter_part<kAffine>(weights, momentum, count, part, nodes, touched);
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
#endif
HWY_AFTER_NAMESPACE();
#endif  // include toggle
