// Sixteen elements at a time: edges from positions, return mapping, forces on corners.
#if defined(REND_MPM_TILE_MESH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MPM_TILE_MESH_INL_H_
#undef REND_MPM_TILE_MESH_INL_H_
#else
#define REND_MPM_TILE_MESH_INL_H_
#endif

#include "engine/mpm/tile_material-inl.h"

HWY_BEFORE_NAMESPACE();
#if HWY_TARGET != HWY_SCALAR
namespace rend {
namespace HWY_NAMESPACE {

/// Rubble thinner than this share of its rest shape carries nothing, as in update_element.
inline constexpr float kCrushedShare2 = 0.25f * 0.25f;

/// Shape and trial strain of sixteen elements. Kinematics is in double, in plain loops over lanes:
/// an element sees small differences of large rotated vectors.
struct alignas(64) ElementShape {
  double F[9][16];       ///< D B
  float inverse[9][16];  ///< D^-1, row k is the gradient of corner k + 1
  float trial[6][16];    ///< b^e - I
  float low[6][16];      ///< and the digits that float has no room for
  float open[16];        ///< 1 when det F > 0
  float regular[16];     ///< 1 when all stretches are surely above kSmallestStretch
};

/// rows: 3 row + column.
HWY_INLINE void invert_lane(const double (*m)[16], int l, double* inverse, double& determinant) {
  const double c0 = m[4][l] * m[8][l] - m[5][l] * m[7][l];
  const double c1 = m[5][l] * m[6][l] - m[3][l] * m[8][l];
  const double c2 = m[3][l] * m[7][l] - m[4][l] * m[6][l];
  determinant = m[0][l] * c0 + m[1][l] * c1 + m[2][l] * c2;
  const double scale = 1 / determinant;
  inverse[0] = c0 * scale;
  inverse[1] = (m[2][l] * m[7][l] - m[1][l] * m[8][l]) * scale;
  inverse[2] = (m[1][l] * m[5][l] - m[2][l] * m[4][l]) * scale;
  inverse[3] = c1 * scale;
  inverse[4] = (m[0][l] * m[8][l] - m[2][l] * m[6][l]) * scale;
  inverse[5] = (m[2][l] * m[3][l] - m[0][l] * m[5][l]) * scale;
  inverse[6] = c2 * scale;
  inverse[7] = (m[1][l] * m[6][l] - m[0][l] * m[7][l]) * scale;
  inverse[8] = (m[0][l] * m[4][l] - m[1][l] * m[3][l]) * scale;
}

inline constexpr int kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};
inline constexpr int kSymmetric[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};

/// out = M M^T - I + M G M^T with M = I + H, for a symmetric G.
HWY_INLINE void push_lane(const double* H, const double* G, double* out) {
  double T[9];
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      double sum = G[kSymmetric[3 * a + b]];
      for (int c = 0; c < 3; ++c) sum += H[3 * a + c] * G[kSymmetric[3 * c + b]];
      T[3 * a + b] = sum;
    }
  for (int i = 0; i < 6; ++i) {
    const int a = kRow[i], b = kColumn[i];
    double sum = H[3 * a + b] + H[3 * b + a] + T[3 * a + b];
    for (int c = 0; c < 3; ++c) sum += (H[3 * a + c] + T[3 * a + c]) * H[3 * b + c];
    out[i] = sum;
  }
}

/// Positions to shape and trial strain of one element tile.
HWY_INLINE void shape_tile(const double* x, const std::int32_t* corners, const float* tile,
                           ElementShape& out) {
  alignas(64) double D[9][16];
  for (int l = 0; l < kLanes; ++l) {
    const double* origin = x + 3 * std::size_t(corners[l]);
    for (int k = 0; k < 3; ++k) {
      const double* corner = x + 3 * std::size_t(corners[(k + 1) * kLanes + l]);
      for (int a = 0; a < 3; ++a) D[3 * a + k][l] = corner[a] - origin[a];
    }
  }
  for (int l = 0; l < kLanes; ++l) {
    double inverse[9], determinant;
    invert_lane(D, l, inverse, determinant);
    for (int i = 0; i < 9; ++i) out.inverse[i][l] = static_cast<float>(inverse[i]);
  }
  const float* map = tile + ElementLayout::kMap * kLanes;
  const float* plastic = tile + ElementLayout::kPlastic * kLanes;
  for (int l = 0; l < kLanes; ++l) {
    double H[9], G[6], e[6];
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) sum += D[3 * a + k][l] * double{map[(3 * k + b) * kLanes + l]};
        out.F[3 * a + b][l] = sum;
        H[3 * a + b] = sum - (a == b ? 1 : 0);
      }
    for (int i = 0; i < 6; ++i) G[i] = plastic[i * kLanes + l];
    push_lane(H, G, e);
    for (int i = 0; i < 6; ++i) {
      out.trial[i][l] = static_cast<float>(e[i]);
      out.low[i][l] = static_cast<float>(e[i] - out.trial[i][l]);
    }
  }
  // det b / (tr b / 2)^2 is below the smallest eigenvalue of b.
  for (int l = 0; l < kLanes; ++l) {
    const double det_F = out.F[0][l] * (out.F[4][l] * out.F[8][l] - out.F[5][l] * out.F[7][l]) +
                         out.F[1][l] * (out.F[5][l] * out.F[6][l] - out.F[3][l] * out.F[8][l]) +
                         out.F[2][l] * (out.F[3][l] * out.F[7][l] - out.F[4][l] * out.F[6][l]);
    const double p = 1 + double{plastic[0 * kLanes + l]}, q = 1 + double{plastic[1 * kLanes + l]};
    const double r = 1 + double{plastic[2 * kLanes + l]}, s = plastic[3 * kLanes + l];
    const double t = plastic[4 * kLanes + l], u = plastic[5 * kLanes + l];
    const double det_G = p * (q * r - t * t) - s * (s * r - t * u) + u * (s * t - q * u);
    const double trace = 3 + double{out.trial[0][l]} + double{out.trial[1][l]} + out.trial[2][l];
    const double slack = 4 * det_F * det_F * det_G - 1.001 * (kSmallestStrain + 1) * trace * trace;
    out.open[l] = static_cast<float>(det_F);
    out.regular[l] = static_cast<float>(slack);
  }
}

/// Largest eigenvalue of sum_q g_q g_q^T for the rows g_1..g_3 of a 3 x 3 matrix and g_0 = -g_1 -
/// g_2 - g_3.
HWY_INLINE Lanes gradient_size(const Lanes* g) {
  Lanes zero_corner[3], m[6];
  for (int a = 0; a < 3; ++a) zero_corner[a] = g[a] + g[3 + a] + g[6 + a];
  for (int i = 0; i < 6; ++i) {
    const int a = kRow[i], b = kColumn[i];
    m[i] = zero_corner[a] * zero_corner[b];
    for (int k = 0; k < 3; ++k) m[i] = mul_add(g[3 * k + a], g[3 * k + b], m[i]);
  }
  const Lanes mean = (m[0] + m[1] + m[2]) * Lanes(1.0f / 3);
  const Lanes a = m[0] - mean, b = m[1] - mean, c = m[2] - mean, d = m[3], e = m[4], f = m[5];
  const Lanes off = mul_add(d, d, mul_add(e, e, f * f));
  const Lanes square = mul_add(a, a, mul_add(b, b, mul_add(c, c, off + off)));
  const Lanes p = max(sqrt(square * Lanes(1.0f / 6)), mean * Lanes(1e-6f));
  const Lanes det =
      mul_add(a, mul_sub(b, c, e * e), mul_add(f, mul_sub(d, e, b * f), d * mul_sub(e, f, d * c)));
  const Lanes ip = Lanes(1.0f) / p;
  const Lanes r = min(max(det * Lanes(0.5f) * ip * ip * ip, Lanes(-1.0f)), Lanes(1.0f));
  return mean + (p + p) * outer_eigenvalue(sqrt(mul_add(r, Lanes(0.5f), Lanes(0.5f))));
}

/// What the law reads and writes: a tile of particles with the strain of the elements.
inline constexpr int kScratchGroups = 12;
struct alignas(64) ElementWork {
  Work work;
  ElementShape shape[kBatch];
  float scratch[kBatch][kScratchGroups * kLanes];
  float largest[kLanes];
};

HWY_INLINE TileLayout scratch_layout() {
  TileLayout layout;
  layout.tau_c = 10;
  layout.tau_c0 = 11;
  layout.groups = kScratchGroups;
  return layout;
}

/// Which lanes the law runs on, and which the caller must treat.
struct ElementMasks {
  LaneMask law, left;
};

HWY_INLINE ElementMasks masks_of(const MaterialConstants& material, const float* tile,
                                 const ElementShape& shape) {
  const Lanes zero(0.0f), volume = load(tile + ElementLayout::kVolume * kLanes);
  const LaneMask there = abs(volume) > zero;
  const LaneMask open = load(shape.open) > zero;
  LaneMask carries = there;
  if (can_be_damaged(material)) {
    const LaneMask damaged = !(load(tile + ElementLayout::kTauC * kLanes) > zero);
    if (any(damaged & there)) {
      Lanes now[9], rest[9];
      for (int i = 0; i < 9; ++i) {
        now[i] = load(shape.inverse[i]);
        rest[i] = load(tile + (ElementLayout::kMap + i) * kLanes);
      }
      const LaneMask sound =
          open & (gradient_size(rest) > Lanes(kCrushedShare2) * gradient_size(now));
      carries = there & (sound | !damaged);
    }
  }
  const LaneMask law = carries & open & (load(shape.regular) > zero);
  return {law, carries & !law};
}

HWY_INLINE std::uint64_t bits_of(LaneMask mask) {
  alignas(64) float all[kLanes];
  store(select(mask, Lanes(1.0f), Lanes(0.0f)), all);
  std::uint64_t bits = 0;
  for (int l = 0; l < kLanes; ++l) bits |= std::uint64_t{all[l] > 0} << l;
  return bits;
}

/// Trial strain and state of the lanes of the law; others get a rest state that does nothing.
HWY_INLINE void fill_scratch(const float* tile, const ElementShape& shape, LaneMask law,
                             float* scratch) {
  const Lanes zero(0.0f);
  const Lanes tau_c0 = load(tile + ElementLayout::kTauC0 * kLanes);
  for (int i = 0; i < 6; ++i)
    store(select(law, load(shape.trial[i]), zero), scratch + (TileLayout::kStrain + i) * kLanes);
  store(select(law, load(tile + ElementLayout::kVolume * kLanes), zero),
        scratch + TileLayout::kVolume * kLanes);
  store(select(law, load(tile + ElementLayout::kTauC * kLanes), tau_c0), scratch + 10 * kLanes);
  store(tau_c0, scratch + 11 * kLanes);
}

/// C_p^-1 - I = F^-1 b^e F^-T - I of the lanes that flowed, and the new state of the law.
HWY_INLINE void keep_flow(const ElementShape& shape, LaneMask law, const float* scratch,
                          float* tile) {
  const Lanes zero(0.0f);
  Lanes change = zero;
  for (int i = 0; i < 6; ++i)
    change += abs(load(scratch + (TileLayout::kStrain + i) * kLanes) - load(shape.trial[i]));
  const LaneMask flowed = law & (change > zero);
  if (any(flowed)) {
    alignas(64) float plastic[6][16];
    for (int l = 0; l < kLanes; ++l) {
      double A[9], e[6], G[6], determinant;
      invert_lane(shape.F, l, A, determinant);
      for (int i = 0; i < 9; i += 4) A[i] -= 1;
      for (int i = 0; i < 6; ++i)
        e[i] = double{scratch[(TileLayout::kStrain + i) * kLanes + l]} + shape.low[i][l];
      push_lane(A, e, G);
      for (int i = 0; i < 6; ++i) plastic[i][l] = static_cast<float>(G[i]);
    }
    for (int i = 0; i < 6; ++i) {
      float* place = tile + (ElementLayout::kPlastic + i) * kLanes;
      store(select(flowed, load(plastic[i]), load(place)), place);
    }
  }
  float* volume = tile + ElementLayout::kVolume * kLanes;
  float* tau_c = tile + ElementLayout::kTauC * kLanes;
  store(select(law, load(scratch + TileLayout::kVolume * kLanes), load(volume)), volume);
  store(select(law, load(scratch + 10 * kLanes), load(tau_c)), tau_c);
}

/// -V tau D^-T, which is -V P grad N because F_e^-T F_p^-T = F^-T.
HWY_INLINE void pull_tile(const float* tile, const ElementShape& shape, LaneMask law,
                          const float stress[6][16], float* pull) {
  alignas(64) float out[ElementLayout::kPull][kLanes];
  const Lanes V = select(law, abs(load(tile + ElementLayout::kVolume * kLanes)), Lanes(0.0f));
  for (int k = 0; k < 3; ++k)
    for (int a = 0; a < 3; ++a) {
      Lanes sum(0.0f);
      for (int b = 0; b < 3; ++b)
        sum = mul_add(load(stress[kSymmetric[3 * a + b]]), load(shape.inverse[3 * k + b]), sum);
      store(select(law, Lanes(0.0f) - V * sum, Lanes(0.0f)), out[3 * k + a]);
    }
  for (int l = 0; l < kLanes; ++l)
    for (int i = 0; i < ElementLayout::kPull; ++i) pull[l * ElementLayout::kPull + i] = out[i][l];
}

HWY_NOINLINE void respond_elements(ElementTask& task) {
  const FlushDenormals flush;
  static thread_local ElementWork work;
  const MaterialConstants& material = *task.material;
  const int tiles = (task.count + kLanes - 1) / kLanes;
  LaneMask law[kBatch];
  task.left = 0;
  for (int t = 0; t < tiles; ++t) {
    const float* tile = task.tiles + t * ElementLayout::kFloats;
    shape_tile(task.x, task.corners + t * ElementLayout::kCorners, tile, work.shape[t]);
    const ElementMasks masks = masks_of(material, tile, work.shape[t]);
    law[t] = masks.law;
    task.left |= bits_of(masks.left) << (t * kLanes);
    fill_scratch(tile, work.shape[t], masks.law, work.scratch[t]);
  }
  task.extremes = RunExtremes{};
  respond_function(material.response)(material, scratch_layout(), work.scratch[0], tiles, work.work,
                                      task.extremes);
  Lanes largest(0.0f);
  for (int t = 0; t < tiles; ++t) {
    float* tile = task.tiles + t * ElementLayout::kFloats;
    keep_flow(work.shape[t], law[t], work.scratch[t], tile);
    pull_tile(tile, work.shape[t], law[t], work.work.stress[t],
              task.pull + t * kLanes * ElementLayout::kPull);
    Lanes gradient[9];
    for (int i = 0; i < 9; ++i) gradient[i] = load(work.shape[t].inverse[i]);
    const Lanes size = gradient_size(gradient) / load(tile + ElementLayout::kLightness * kLanes);
    largest = max(largest, select(law[t], size, Lanes(0.0f)));
  }
  task.shape2 = max_of_lanes(largest);
}

HWY_NOINLINE void measure_elements(ElementTask& task, float* energy, float* stress) {
  const FlushDenormals flush;
  static thread_local ElementWork work;
  const int tiles = (task.count + kLanes - 1) / kLanes;
  task.left = 0;
  for (int t = 0; t < tiles; ++t) {
    const float* tile = task.tiles + t * ElementLayout::kFloats;
    shape_tile(task.x, task.corners + t * ElementLayout::kCorners, tile, work.shape[t]);
    const ElementMasks masks = masks_of(*task.material, tile, work.shape[t]);
    task.left |= bits_of(masks.left) << (t * kLanes);
    fill_scratch(tile, work.shape[t], masks.law, work.scratch[t]);
  }
  measure_tiles(scratch_layout(), *task.material, work.scratch[0], tiles, energy, stress, nullptr,
                nullptr);
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
#endif
HWY_AFTER_NAMESPACE();
#endif  // include toggle
