// Rankine and von Mises at once: tension and shear are both bounded (mixed modes I to III).
#if defined(REND_MATERIAL_RANKINE_VON_MISES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_RANKINE_VON_MISES_INL_H_
#undef REND_MATERIAL_RANKINE_VON_MISES_INL_H_
#else
#define REND_MATERIAL_RANKINE_VON_MISES_INL_H_
#endif

#include "engine/material/rankine-inl.h"

REND_LAW_BEGIN()

/// y(tau) = max(max_i tau_i - tau_c, |dev tau|_F - r tau_c) with r = shear_ratio; both bounds
/// shrink together. Radial return, g = (|s| - r tau_c) / (2 mu - r alpha), then Rankine's return,
/// each with its own implicit softening, give the threshold that is left; both returns at that
/// threshold give the stress. Cutting principal stresses shortens their deviator and keeps their
/// order, so the result is admissible and dissipative; it is not the closest point.
struct RankineVonMises {
  static constexpr const char* kName = "rankine_von_mises";
  static constexpr std::array<Parameter, 3> kParameters{{
      {"tau_c", "Yield threshold", "Pa", 0, 1e12, std::numeric_limits<Real>::quiet_NaN(),
       "Largest principal Kirchhoff stress that the intact material carries."},
      {"softening", "Softening", "Pa", -1e12, 1e12, 0,
       "Loss of tensile strength per unit of plastic strain; negative hardens."},
      {"shear_ratio", "Shear ratio", "-", 1e-3, 1e3, 1,
       "Bound of the Frobenius norm of the deviatoric stress over the tensile strength."},
  }};
  static constexpr int kThreshold = 0;

  enum { kRatio = Rankine::kFlow3 + 1, kShearKeep, kShearSolve };

  /// Fills the constants from kParameters; returns true on snap-back of either part.
  static bool prepare(const Lame& lame, const Real* value, SofteningRule rule, Real* k) {
    const bool tension = Rankine::prepare(lame, value, rule, k);
    const bool is_explicit = rule == SofteningRule::explicit_rule;
    const Real slope = value[1] * value[2];
    const bool shear = !is_explicit && slope >= 2 * lame.mu;
    k[kRatio] = value[2];
    k[kShearKeep] = shear ? 0 : 1;
    k[kShearSolve] = 1 / (2 * lame.mu - (is_explicit || shear ? 0 : slope));
    return tension || shear;
  }

  template <class S>
  static REND_LAW_INLINE S value(const LawConstants<S>& k, const Triple<S>& eps, S tau_c) {
    return max(Rankine::value(k, eps, tau_c),
               k.mu2 * norm(deviator(eps)) - k.surface[kRatio] * tau_c);
  }

  /// The strain of this volume whose deviator is at most `bound` long.
  template <class S>
  static REND_LAW_INLINE Triple<S> shortened(const Triple<S>& dev, S length, S volume, S bound) {
    const S scale = max(length - bound, S(0)) / max(length, S(1e-30));
    const S mean = volume * S(1.0 / 3);
    return {{dev[0] - dev[0] * scale + mean, dev[1] - dev[1] * scale + mean,
             dev[2] - dev[2] * scale + mean}};
  }

  template <class S>
  static REND_LAW_INLINE ReturnMap<S> return_map(const LawConstants<S>& k, const Triple<S>& eps,
                                                 S tau_c) {
    const S* c = k.surface;
    const S zero(0);
    const Triple<S> dev = deviator(eps);
    const S length = norm(dev);
    const S excess = k.mu2 * length - c[kRatio] * tau_c;
    const Mask<S> sheared = excess > zero;
    const S driver = max(excess, zero) * c[kShearSolve];
    const S sheared_tau_c =
        select(sheared, c[kShearKeep] * max(tau_c - c[Rankine::kAlpha] * driver, zero), tau_c);
    const Mask<S> is_explicit = c[Rankine::kExplicit] > zero;
    const S first = select(is_explicit, tau_c, sheared_tau_c);
    const ReturnMap<S> cut = Rankine::return_map(
        k, shortened(dev, length, trace(eps), c[kRatio] * first / k.mu2), first);
    const S next = max(sheared_tau_c + (cut.tau_c - first), zero);

    // Both returns again at the threshold that is left, now without softening.
    const S cap = select(is_explicit, tau_c, next);
    const S bound = c[kRatio] * cap / k.mu2;
    const Triple<S> kept = shortened(dev, length, trace(eps), bound);
    const Triple<S> last = Rankine::plastic_at(k, kept, cap);
    const Mask<S> yielded = sheared | (Rankine::value(k, eps, tau_c) > zero);
    Triple<S> plastic;
    for (int i = 0; i < 3; ++i) plastic[i] = select(yielded, (eps[i] - kept[i]) + last[i], zero);
    const S total = c[kRatio] * max(length - bound, zero) + trace(last);
    const S alpha = c[Rankine::kAlpha];
    const S work =
        softening_work(tau_c, next, total, alpha, max(tau_c - next, zero) / max(alpha, S(1e-30)));
    return {plastic, select(yielded, next, tau_c), select(yielded, work, zero), yielded};
  }
};

REND_LAW_END()

#endif
