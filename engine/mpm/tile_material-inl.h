// Stress and return mapping of sixteen particles from b^e - I, without eigenvectors and without
// branches.
#if defined(REND_MPM_TILE_MATERIAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MPM_TILE_MATERIAL_INL_H_
#undef REND_MPM_TILE_MATERIAL_INL_H_
#else
#define REND_MPM_TILE_MATERIAL_INL_H_
#endif

#include "engine/material/material_law-inl.h"
#include "engine/mpm/tile_transfer-inl.h"

HWY_BEFORE_NAMESPACE();
#if HWY_TARGET != HWY_SCALAR
namespace rend {
namespace HWY_NAMESPACE {

/// Smallest eigenvalue of b^e - I that the laws see: kSmallestStretch of material_point.h, squared,
/// minus 1.
inline constexpr float kSmallestStrain = 0.05f * 0.05f - 1;

/// sqrt(2 / 3) cos(acos(2 y^2 - 1) / 3) fitted in y on [0, 1]; gives the outer eigenvalues of a
/// deviator.
HWY_INLINE Lanes outer_eigenvalue(Lanes y) {
  Lanes p(0.00112763624f);
  for (const float c : {-0.00608934568f, 0.0160472804f, -0.0302353976f, 0.0528414091f,
                        -0.111038511f, 0.577346917f, 0.500000026f})
    p = mul_add(p, y, Lanes(c));
  return p;
}

/// Spectrum of e = b^e - I = mean 1 + B with B the deviator. A function f of e is rebuilt by Newton
/// interpolation in the eigenvalues, f2 1 + f12 (B - b2) + f123 (B - b2)(B - b1), which needs no
/// eigenvectors and is exact to second order where eigenvalues coincide.
struct Spectrum {
  Lanes B[6];                 ///< xx yy zz xy yz zx
  Lanes B2[6];                ///< B B
  Lanes b1, b2, b3;           ///< eigenvalues of B, b1 >= b2 >= b3
  Lanes inv12, inv23, inv13;  ///< 1 / (b1 - b2), 1 / (b2 - b3), 1 / (b1 - b3)
  Lanes size;                 ///< middle eigenvalue of b^e
  Triple<Lanes> eps;          ///< Hencky strain, in the order of b
  LaneMask clamped;           ///< an eigenvalue was raised to kSmallestStrain

  HWY_INLINE explicit Spectrum(const Lanes* e) {
    const Lanes one(1.0f), half(0.5f), zero(0.0f);
    const Lanes mean = (e[0] + e[1] + e[2]) * Lanes(1.0f / 3);
    for (int i = 0; i < 3; ++i) B[i] = e[i] - mean;
    for (int i = 3; i < 6; ++i) B[i] = e[i];
    const Lanes a = B[0], b = B[1], c = B[2], d = B[3], g = B[4], h = B[5];
    B2[0] = mul_add(a, a, mul_add(d, d, h * h));
    B2[1] = mul_add(d, d, mul_add(b, b, g * g));
    B2[2] = mul_add(h, h, mul_add(g, g, c * c));
    B2[3] = mul_add(a, d, mul_add(d, b, h * g));
    B2[4] = mul_add(d, h, mul_add(b, g, g * c));
    B2[5] = mul_add(h, a, mul_add(g, d, c * h));
    const Lanes p = max(sqrt((B2[0] + B2[1] + B2[2]) * Lanes(1.0f / 6)), Lanes(1e-12f));
    const Lanes det = mul_add(a, mul_sub(b, c, g * g),
                              mul_add(h, mul_sub(d, g, b * h), d * mul_sub(g, h, d * c)));
    const Lanes ip = one / p;
    const Lanes r = min(max(det * half * ip * ip * ip, Lanes(-1.0f)), one);
    const Lanes high = outer_eigenvalue(sqrt(mul_add(r, half, half)));
    const Lanes low = outer_eigenvalue(sqrt(neg_mul_add(r, half, half)));
    const Lanes p2 = p + p;
    b1 = p2 * high;
    b2 = p2 * (low - high);
    b3 = zero - p2 * low;
    // Differences over 2 p. A wrong difference of a nearly double pair does no harm; 0 would.
    const Lanes least = mul_add(ip, Lanes(1e-12f), Lanes(1e-7f));
    const Lanes up = max(high + (high - low), least), down = max(low + (low - high), least);
    const Lanes both = up + down;
    const Lanes smallest(kSmallestStrain);
    clamped = mean + b3 < smallest;
    const Lanes middle = max(mean + b2, smallest);
    // One division gives the four reciprocals.
    size = one + middle;
    const Lanes product = up * down * both;
    const Lanes quotient = one / (product * size);
    const Lanes scale = quotient * product;
    const Lanes inverse = quotient * size * (half * ip);
    inv12 = inverse * down * both;
    inv23 = inverse * up * both;
    inv13 = inverse * up * down;
    const Lanes log2 = half * log1p(middle);
    const Lanes log_up = half * log1p(p2 * up * scale);
    const Lanes lowest = (smallest - middle) * scale;
    const Lanes log_down = half * log1p(max(zero - p2 * down * scale, lowest));
    eps = {{log2 + log_up, log2, log2 + log_down}};
  }

  /// f2 1 + f12 (B - b2) + f123 (B - b2)(B - b1) for f2 = f(b2), f12 = f[b1, b2], f32 = f[b3, b2].
  HWY_INLINE void rebuild(Lanes f2, Lanes f12, Lanes f32, Lanes* out) const {
    const Lanes f123 = (f12 - f32) * inv13;
    const Lanes k0 = neg_mul_add(f12, b2, mul_add(f123, b1 * b2, f2));
    const Lanes k1 = mul_add(f123, b3, f12);
    for (int i = 0; i < 3; ++i) out[i] = mul_add(f123, B2[i], mul_add(k1, B[i], k0));
    for (int i = 3; i < 6; ++i) out[i] = mul_add(f123, B2[i], k1 * B[i]);
  }

  /// Kirchhoff stress [Pa] of the strain `kept`, with the directions of this spectrum.
  HWY_INLINE void stress(Lanes mu2, Lanes lambda, const Triple<Lanes>& kept, Lanes* out) const {
    const Lanes middle = mul_add(mu2, kept[1], lambda * trace(kept));
    rebuild(middle, mu2 * (kept[0] - kept[1]) * inv12, mu2 * (kept[1] - kept[2]) * inv23, out);
  }

  /// e + (exp(2 d) - 1) b with d = kept - eps: b - I of the strain `kept`. As a change, so that
  /// what flow leaves alone keeps its digits, step by step; differences are taken before the
  /// exponential.
  HWY_INLINE void strain(const Triple<Lanes>& kept, const Lanes* e, Lanes* out) const {
    const Lanes d = kept[1] - eps[1];
    const Lanes up = kept[0] - eps[0] - d, down = kept[2] - eps[2] - d;
    const Lanes middle = expm1(d + d), scale = Lanes(1.0f) + middle;
    const Lanes rise = scale * expm1(up + up), fall = scale * expm1(down + down);
    Lanes change[6];
    rebuild(size * middle, mul_add(size * rise, inv12, middle + rise),
            neg_mul_add(size * fall, inv23, middle + fall), change);
    for (int i = 0; i < 6; ++i) out[i] = e[i] + change[i];
  }

  /// The same where eps is not the strain of e, because it was clamped: exp(2 kept) - 1.
  HWY_INLINE void clamped_strain(const Triple<Lanes>& kept, Lanes* out) const {
    const Lanes up = kept[0] - kept[1], down = kept[2] - kept[1];
    const Lanes middle = expm1(kept[1] + kept[1]);
    const Lanes scale = Lanes(1.0f) + middle;
    rebuild(middle, scale * expm1(up + up) * inv12,
            Lanes(0.0f) - scale * expm1(down + down) * inv23, out);
  }
};

HWY_INLINE void load_strain(const float* tile, Lanes* e) {
  for (int i = 0; i < 6; ++i) e[i] = load(tile + (TileLayout::kStrain + i) * kLanes);
}

/// Return mapping of a batch of tiles: reads the trial strain, writes the admissible one, its
/// stress into work.
template <class Law, class Damage>
HWY_NOINLINE void respond_batch(const MaterialConstants& material, const TileLayout& layout,
                                float* tiles, int tile_count, Work& work, RunExtremes& extremes) {
  const LawConstants<Lanes> k = convert_constants<Lanes>(material.law);
  Lanes least_stress(0.0f), dissipation(0.0f), clamped(0.0f);
  for (int t = 0; t < tile_count; ++t) {
    float* tile = tiles + std::size_t(t) * layout.floats();
    Lanes e[6], stress[6];
    load_strain(tile, e);
    const Spectrum spectrum(e);
    Lanes tau_c(1.0f), tau_c0(material.tau_c0);
    if constexpr (Law::kThreshold >= 0) tau_c = load(tile + layout.tau_c * kLanes);
    if constexpr (Damage::kActive)
      if (layout.tau_c0 >= 0) tau_c0 = load(tile + layout.tau_c0 * kLanes);
    const MaterialResponse<Lanes> response =
        material_response<Law, Damage>(k, spectrum.eps, tau_c, tau_c0);
    spectrum.stress(response.mu2, k.lambda, response.eps, stress);
    for (int i = 0; i < 6; ++i) store(stress[i], work.stress[t][i]);
    least_stress = min(least_stress, response.stress[2]);
    const LaneMask changed = response.yielded | spectrum.clamped;
    if (any(changed)) {
      Lanes admissible[6];
      spectrum.strain(response.eps, e, admissible);
      if (any(spectrum.clamped)) {
        Lanes raised[6];
        spectrum.clamped_strain(response.eps, raised);
        for (int i = 0; i < 6; ++i)
          admissible[i] = select(spectrum.clamped, raised[i], admissible[i]);
      }
      for (int i = 0; i < 6; ++i)
        store(select(changed, admissible[i], e[i]), tile + (TileLayout::kStrain + i) * kLanes);
      const LaneMask real = abs(load(tile + TileLayout::kVolume * kLanes)) > Lanes(0.0f);
      clamped += select(spectrum.clamped & real, Lanes(1.0f), Lanes(0.0f));
      if constexpr (Law::kThreshold >= 0) {
        store(response.tau_c, tile + layout.tau_c * kLanes);
        float* volume = tile + TileLayout::kVolume * kLanes;
        const Lanes V = load(volume), size = abs(V);
        store(select(response.yielded, Lanes(0.0f) - size, V), volume);
        dissipation = mul_add(response.dissipation, size, dissipation);
      }
    }
  }
  const float least = -max_of_lanes(Lanes(0.0f) - least_stress);
  if (least < extremes.least_stress) extremes.least_stress = least;
  if constexpr (Law::kThreshold >= 0) extremes.dissipation += sum_of_lanes(dissipation);
  extremes.clamped += int(sum_of_lanes(clamped));
}

HWY_INLINE bool can_be_damaged(const MaterialConstants& material) {
  return material.response >= 3 && material.response % 3 != 0;
}
HWY_INLINE Lanes shear_modulus_in_force(const LawConstants<Lanes>& k, Lanes tau_c) {
  return select(tau_c > Lanes(0.0f), k.mu2, k.damage_mu2);
}

/// Elastic response alone, for the first scatter of a frame: the stored strain is admissible
/// already.
HWY_NOINLINE void stress_batch(const MaterialConstants& material, const TileLayout& layout,
                               const float* tiles, int tile_count, Work& work) {
  const LawConstants<Lanes> k = convert_constants<Lanes>(material.law);
  const bool damage = can_be_damaged(material);
  for (int t = 0; t < tile_count; ++t) {
    const float* tile = tiles + std::size_t(t) * layout.floats();
    Lanes e[6], stress[6], mu2 = k.mu2;
    load_strain(tile, e);
    const Spectrum spectrum(e);
    if (damage) mu2 = shear_modulus_in_force(k, load(tile + layout.tau_c * kLanes));
    spectrum.stress(mu2, k.lambda, spectrum.eps, stress);
    for (int i = 0; i < 6; ++i) store(stress[i], work.stress[t][i]);
  }
}

using RespondBatch = void (*)(const MaterialConstants&, const TileLayout&, float*, int, Work&,
                              RunExtremes&);

/// The return mapping of a material; its response is 3 * yield surface + damage.
inline RespondBatch respond_function(int response) {
  RespondBatch chosen = nullptr;
  with_material_law(response / 3, response % 3, [&](auto law, auto damage) {
    chosen = respond_batch<decltype(law), decltype(damage)>;
  });
  return chosen;
}

HWY_NOINLINE void respond_tiles(const TileLayout& layout, const MaterialConstants& material,
                                float* tiles, int tile_count, RunExtremes& extremes) {
  const FlushDenormals flush;
  static thread_local Work work;
  for (int t = 0; t < tile_count; t += kBatch)
    respond_function(material.response)(material, layout, tiles + std::size_t(t) * layout.floats(),
                                        tile_count - t < kBatch ? tile_count - t : kBatch, work,
                                        extremes);
}

/// Elastic energy density and largest principal stress, once a frame; with `motion` also the power
/// of the stress, tau : C.
HWY_NOINLINE void measure_tiles(const TileLayout& layout, const MaterialConstants& material,
                                const float* tile, int tiles, float* energy, float* stress,
                                const float* motion, float* power) {
  const LawConstants<Lanes> k = convert_constants<Lanes>(material.law);
  const bool damage = can_be_damaged(material);
  for (int t = 0; t < tiles; ++t, tile += layout.floats()) {
    Lanes e[6], mu2 = k.mu2;
    load_strain(tile, e);
    if (damage) mu2 = shear_modulus_in_force(k, load(tile + layout.tau_c * kLanes));
    const Spectrum spectrum(e);
    store(energy_density(mu2, k.lambda, spectrum.eps), energy + t * kLanes);
    store(principal_stress(mu2, k.lambda, spectrum.eps)[0], stress + t * kLanes);
    if (!motion) continue;
    Lanes tau[6];
    spectrum.stress(mu2, k.lambda, spectrum.eps, tau);
    constexpr int place[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
    Lanes sum(0.0f);
    for (int i = 0; i < 9; ++i)
      sum = mul_add(tau[place[i]], load(motion + t * kMotionFloats + (3 + i) * kLanes), sum);
    store(sum, power + t * kLanes);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
#endif
HWY_AFTER_NAMESPACE();
#endif  // include toggle
