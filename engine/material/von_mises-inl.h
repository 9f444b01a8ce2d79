// Von Mises (J2) yield surface: the deviatoric Kirchhoff stress is bounded (modes II and III,
// shear).
#if defined(REND_MATERIAL_VON_MISES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_VON_MISES_INL_H_
#undef REND_MATERIAL_VON_MISES_INL_H_
#else
#define REND_MATERIAL_VON_MISES_INL_H_
#endif

#include "engine/material/return_map-inl.h"

#include <array>
#include <limits>

REND_LAW_BEGIN()

/// y(tau) = |tau - tr(tau)/3 1|_F - tau_c, radial return with plastic strain g = (|s| - tau_c) / (2
/// mu - alpha) and tau_c' = tau_c - alpha g, never below 0. alpha >= 2 mu is local snap-back: the
/// threshold falls to 0 at once. The Frobenius norm makes tau_c = sqrt(2/3) times the uniaxial
/// yield stress.
struct VonMises {
  static constexpr const char* kName = "von_mises";
  static constexpr std::array<Parameter, 2> kParameters{{
      {"tau_c", "Yield threshold", "Pa", 0, 1e12, std::numeric_limits<Real>::quiet_NaN(),
       "Frobenius norm of the deviatoric Kirchhoff stress that the intact material carries."},
      {"softening", "Softening", "Pa", -1e12, 1e12, 0,
       "Loss of strength per unit of plastic strain; negative hardens."},
  }};
  static constexpr int kThreshold = 0;

  enum { kAlpha, kKeep, kExplicit, kSolve };

  /// Fills the constants from kParameters; returns true on snap-back.
  static bool prepare(const Lame& lame, const Real* value, SofteningRule rule, Real* k) {
    const bool is_explicit = rule == SofteningRule::explicit_rule;
    const Real alpha = value[1];
    const bool snap = !is_explicit && alpha >= 2 * lame.mu;
    k[kAlpha] = alpha;
    k[kKeep] = snap ? 0 : 1;
    k[kExplicit] = is_explicit ? 1 : 0;
    k[kSolve] = 1 / (2 * lame.mu - (is_explicit || snap ? 0 : alpha));
    return snap;
  }

  template <class S>
  static REND_LAW_INLINE S value(const LawConstants<S>& k, const Triple<S>& eps, S tau_c) {
    return k.mu2 * norm(deviator(eps)) - tau_c;
  }

  template <class S>
  static REND_LAW_INLINE ReturnMap<S> return_map(const LawConstants<S>& k, const Triple<S>& eps,
                                                 S tau_c) {
    const S* c = k.surface;
    const S zero(0);
    const Triple<S> dev = deviator(eps);
    const S length = norm(dev);
    const S excess = k.mu2 * length - tau_c;
    const Mask<S> yielded = excess > zero;
    const S softened =
        select(yielded, c[kKeep] * max(tau_c - c[kAlpha] * (excess * c[kSolve]), zero), tau_c);
    const S cap = select(c[kExplicit] > zero, tau_c, softened);
    const S plastic = select(yielded, max(length - cap * k.inverse_mu2, zero), zero);
    const S scale = plastic / max(length, S(1e-30));
    return {{{dev[0] * scale, dev[1] * scale, dev[2] * scale}},
            softened,
            softening_work(tau_c, softened, plastic, c[kAlpha], plastic),
            yielded};
  }
};

REND_LAW_END()

#endif
