// Drucker-Prager yield surface: shear strength grows with pressure (soil, sand, concrete).
#if defined(REND_MATERIAL_DRUCKER_PRAGER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_DRUCKER_PRAGER_INL_H_
#undef REND_MATERIAL_DRUCKER_PRAGER_INL_H_
#else
#define REND_MATERIAL_DRUCKER_PRAGER_INL_H_
#endif

#include "engine/material/return_map-inl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

REND_LAW_BEGIN()

/// y(tau) = |dev tau|_F + M tr(tau)/3 - A c with cohesion c (the threshold), the cone through the
/// triaxial compression corners of Mohr-Coulomb: M = sqrt(2/3) 6 sin(phi) / (3 - sin(phi)),
/// A = sqrt(2/3) 6 cos(phi) / (3 - sin(phi)). Not associative: shear flow keeps volume (Klar et al.
/// 2016); beyond the tip the volume returns to it. c' = c - alpha times plastic volume and shear
/// strain, implicit in each part. Matter that has lost its cohesion is handed to granular damage,
/// which holds the volume correction of Tampubolon et al. 2017: sand is cohesion 0 with it.
struct DruckerPrager {
  static constexpr const char* kName = "drucker_prager";
  static constexpr std::array<Parameter, 3> kParameters{{
      {"cohesion", "Cohesion", "Pa", 0, 1e12, std::numeric_limits<Real>::quiet_NaN(),
       "Mohr-Coulomb shear strength without pressure."},
      {"softening", "Softening", "Pa", -1e12, 1e12, 0,
       "Loss of cohesion per unit of plastic strain; negative hardens."},
      {"friction_angle", "Friction angle", "deg", 0, 89, 30, "Of the intact material."},
  }};
  static constexpr int kThreshold = 0;

  // kTip: tr eps of the tip per cohesion, kTipLeast: floor of it that removes the tip without
  // friction.
  enum { kAlpha, kExplicit, kCohesion, kFriction, kTip, kTipLeast, kKeep, kOpenSolve, kShearSolve };

  /// Fills the constants from kParameters; returns true on snap-back: cohesion is lost at once when
  /// either part softens faster than it unloads.
  static bool prepare(const Lame& lame, const Real* value, SofteningRule rule, Real* k) {
    const bool is_explicit = rule == SofteningRule::explicit_rule;
    const Real angle = value[2] * std::numbers::pi / 180, sine = std::sin(angle);
    const Real cone = std::sqrt(2.0 / 3) * 6 / (3 - sine);
    const Real A = cone * std::cos(angle);
    const Real friction = cone * sine * (lame.lambda + 2 * lame.mu / 3);
    const Real slope = is_explicit ? 0 : A * value[1];
    const bool snap = slope >= (friction > 0 ? std::min(friction, 2 * lame.mu) : 2 * lame.mu);
    k[kAlpha] = value[1];
    k[kExplicit] = is_explicit ? 1 : 0;
    k[kCohesion] = A;
    k[kFriction] = friction;
    k[kTip] = friction > 0 ? A / friction : 0;
    k[kTipLeast] = friction > 0 ? 0 : 1e30;
    k[kKeep] = snap ? 0 : 1;
    k[kOpenSolve] = friction > 0 ? 1 / (friction - (snap ? 0 : slope)) : 0;
    k[kShearSolve] = 1 / (2 * lame.mu - (snap ? 0 : slope));
    return snap;
  }

  template <class S>
  static REND_LAW_INLINE S value(const LawConstants<S>& k, const Triple<S>& eps, S cohesion) {
    const S* c = k.surface;
    return (c[kFriction] * trace(eps) - c[kCohesion] * cohesion) + k.mu2 * norm(deviator(eps));
  }

  template <class S>
  static REND_LAW_INLINE ReturnMap<S> return_map(const LawConstants<S>& k, const Triple<S>& eps,
                                                 S cohesion) {
    const S* c = k.surface;
    const S zero(0);
    const Mask<S> is_explicit = c[kExplicit] > zero;
    const S volume = trace(eps);
    const Triple<S> dev = deviator(eps);
    const S length = norm(dev);
    const Mask<S> yielded = value(k, eps, cohesion) > zero;

    // Opening beyond the tip, then shear at what is left, then the tip of the final cohesion.
    const S beyond = c[kFriction] * volume - c[kCohesion] * cohesion;
    const S opening = max(beyond, zero) * c[kOpenSolve];
    const S first =
        select(beyond > zero, c[kKeep] * max(cohesion - c[kAlpha] * opening, zero), cohesion);
    const S held = select(is_explicit, cohesion, first);
    const S volume1 = min(volume, max(c[kTip] * held, c[kTipLeast]));
    const S excess = (c[kFriction] * volume1 - c[kCohesion] * held) + k.mu2 * length;
    const S slip = max(excess, zero) * c[kShearSolve];
    const S softened =
        select(yielded & (excess > zero), c[kKeep] * max(first - c[kAlpha] * slip, zero), first);
    const S final = select(is_explicit, cohesion, softened);
    const S volume2 = min(volume1, max(c[kTip] * final, c[kTipLeast]));
    const S bound = max(c[kCohesion] * final - c[kFriction] * volume2, zero) / k.mu2;
    const S kept = min(length, bound);
    const S scale = (length - kept) / max(length, S(1e-30));
    const S lost = (volume - volume2) * S(1.0 / 3);
    Triple<S> plastic;
    for (int i = 0; i < 3; ++i) plastic[i] = select(yielded, dev[i] * scale + lost, zero);
    const S bulk3 = S(3) * k.lambda + k.mu2;
    const S work = k.mu2 * kept * (length - kept) + bulk3 * volume2 * lost;
    return {plastic, select(yielded, softened, cohesion), select(yielded, max(work, zero), zero),
            yielded};
  }
};

REND_LAW_END()

#endif
