// Rankine yield surface: the largest principal Kirchhoff stress is bounded (mode I, tension).
#if defined(REND_MATERIAL_RANKINE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_RANKINE_INL_H_
#undef REND_MATERIAL_RANKINE_INL_H_
#else
#define REND_MATERIAL_RANKINE_INL_H_
#endif

#include "engine/material/return_map-inl.h"

#include <array>
#include <limits>

REND_LAW_BEGIN()

/// y(tau) = max_i tau_i - tau_c, associative flow, threshold tau_c' = tau_c - alpha max_i
/// plastic_i, never below 0. With k principal stresses at the threshold and M_k = 2 mu + k lambda
/// the largest plastic strain is
///   g_k = (tau_1 - tau_c + lambda sum_{i<=k} (eps_1 - eps_i)) / (M_k - alpha),
/// and the right k is the one that gives the smallest g_k (the largest for lambda < 0), so no case
/// is chosen and nothing is sorted. alpha >= M_1 is local snap-back: the threshold falls to 0 at
/// once.
struct Rankine {
  static constexpr const char* kName = "rankine";
  static constexpr std::array<Parameter, 2> kParameters{{
      {"tau_c", "Yield threshold", "Pa", 0, 1e12, std::numeric_limits<Real>::quiet_NaN(),
       "Largest principal Kirchhoff stress that the intact material carries."},
      {"softening", "Softening", "Pa", -1e12, 1e12, 0,
       "Loss of strength per unit of plastic principal strain; negative hardens."},
  }};
  static constexpr int kThreshold = 0;

  enum { kAlpha, kKeep, kExplicit, kSign, kSolve1, kSolve2, kSolve3, kFlow1, kFlow2, kFlow3 };

  /// Fills the constants from kParameters; returns true on snap-back.
  static bool prepare(const Lame& lame, const Real* value, SofteningRule rule, Real* k) {
    const bool is_explicit = rule == SofteningRule::explicit_rule;
    const Real mu2 = 2 * lame.mu, lambda = lame.lambda, alpha = value[1];
    const Real steepest = mu2 + (lambda < 0 ? 3 * lambda : lambda);
    const bool snap = !is_explicit && alpha >= steepest;
    const Real sign = lambda < 0 ? -1 : 1;
    const Real implicit_alpha = is_explicit || snap ? 0 : alpha;
    k[kAlpha] = alpha;
    k[kKeep] = snap ? 0 : 1;
    k[kExplicit] = is_explicit ? 1 : 0;
    k[kSign] = sign;
    for (int n = 1; n <= 3; ++n) {
      k[kSolve1 + n - 1] = sign / (mu2 + n * lambda - implicit_alpha);
      k[kFlow1 + n - 1] = 1 / (mu2 + n * lambda);
    }
    return snap;
  }

  template <class S>
  static REND_LAW_INLINE S value(const LawConstants<S>& k, const Triple<S>& eps, S tau_c) {
    const Triple<S> tau = principal_stress(k.mu2, k.lambda, eps);
    return max(max(tau[0], tau[1]), tau[2]) - tau_c;
  }

  /// Plastic strain that cuts every principal stress at `cap`.
  template <class S>
  static REND_LAW_INLINE Triple<S> plastic_at(const LawConstants<S>& k, const Triple<S>& eps,
                                              S cap) {
    const S* c = k.surface;
    const S zero(0);
    const S high = max(eps[0], eps[1]), low = min(eps[0], eps[1]);
    const S e1 = max(high, eps[2]), e2 = max(low, min(high, eps[2])), e3 = min(low, eps[2]);
    const S pressure = k.lambda * trace(eps);
    const S over1 = k.mu2 * e1 + pressure - cap;
    const S over2 = over1 + (k.mu2 * e2 + pressure - cap);
    const S over3 = over2 + (k.mu2 * e3 + pressure - cap);
    const S sum = max(max(over1 * c[kFlow1], zero), max(over2 * c[kFlow2], over3 * c[kFlow3]));
    const S relief = pressure - k.lambda * sum - cap;
    Triple<S> plastic;
    for (int i = 0; i < 3; ++i) plastic[i] = max((k.mu2 * eps[i] + relief) / k.mu2, zero);
    return plastic;
  }

  template <class S>
  static REND_LAW_INLINE ReturnMap<S> return_map(const LawConstants<S>& k, const Triple<S>& eps,
                                                 S tau_c) {
    const S* c = k.surface;
    const S zero(0);
    const S high = max(eps[0], eps[1]), low = min(eps[0], eps[1]);
    const S e1 = max(high, eps[2]), e2 = max(low, min(high, eps[2])), e3 = min(low, eps[2]);
    const S pressure = k.lambda * trace(eps);

    const S excess1 = k.mu2 * e1 + pressure - tau_c;
    const S excess2 = excess1 + k.lambda * (e1 - e2);
    const S excess3 = excess2 + k.lambda * (e1 - e3);
    const S root =
        c[kSign] * min(min(excess1 * c[kSolve1], excess2 * c[kSolve2]), excess3 * c[kSolve3]);
    const Mask<S> yielded = excess1 > zero;
    const S softened =
        select(yielded, c[kKeep] * max(tau_c - c[kAlpha] * max(root, zero), zero), tau_c);

    const S cap = select(c[kExplicit] > zero, tau_c, softened);
    Triple<S> plastic = plastic_at(k, eps, cap);
    for (int i = 0; i < 3; ++i) plastic[i] = select(yielded, plastic[i], zero);
    const S driver = max(max(plastic[0], plastic[1]), plastic[2]);
    return {plastic, softened, softening_work(tau_c, softened, trace(plastic), c[kAlpha], driver),
            yielded};
  }
};

REND_LAW_END()

#endif
