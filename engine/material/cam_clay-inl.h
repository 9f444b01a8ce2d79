// Cam clay yield surface with cohesion: crushes, hardens under pressure and softens when it dilates
// (snow, bread, biscuit).
#if defined(REND_MATERIAL_CAM_CLAY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_CAM_CLAY_INL_H_
#undef REND_MATERIAL_CAM_CLAY_INL_H_
#else
#define REND_MATERIAL_CAM_CLAY_INL_H_
#endif

#include "engine/material/return_map-inl.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

REND_LAW_BEGIN()

/// Non-associated cam clay (Wolper et al. 2019) carried over to Hencky strain: the ellipse
/// (1 + 2 beta) q^2 + M^2 (p + beta p0)(p - p0) <= 0 in pressure p = -K tr eps and q = sqrt(3/2)
/// |dev tau|, as y = max(q - q_max(p), p - p0, -beta p0 - p) in Pa, M = 6 sin(phi) / (3 -
/// sin(phi)). Beyond a tip the stress returns to the tip, else shear alone is scaled down and
/// volume is kept. The threshold is p0 = K sinh(xi a), where a grows with plastic compaction: of
/// the return to a tip, or of the point where the ray from the centre of the ellipse meets it. A
/// smaller p0 holds after the return.
struct CamClay {
  static constexpr const char* kName = "cam_clay";
  static constexpr std::array<Parameter, 4> kParameters{{
      {"preconsolidation", "Crushing pressure", "Pa", 0, 1e12,
       std::numeric_limits<Real>::quiet_NaN(), "Pressure that crushes the intact material."},
      {"cohesion_ratio", "Cohesion", "-", 0, 10, 0.5, "Tensile strength over crushing pressure."},
      {"hardening", "Hardening", "-", 0, 100, 1,
       "Growth of the crushing pressure with compaction."},
      {"friction_angle", "Friction angle", "deg", 1, 89, 45, "Slope of the critical state line."},
  }};
  static constexpr int kThreshold = 0;

  enum { kBulk, kBeta, kHardening, kSlope };

  static bool prepare(const Lame& lame, const Real* value, SofteningRule, Real* k) {
    const Real sine = std::sin(value[3] * std::numbers::pi / 180);
    k[kBulk] = lame.lambda + 2 * lame.mu / 3;
    k[kBeta] = value[1];
    k[kHardening] = value[2];
    // Of |dev tau| over sqrt((p + beta p0)(p0 - p)).
    k[kSlope] = std::sqrt(2.0 / 3) * 6 * sine / (3 - sine) / std::sqrt(1 + 2 * value[1]);
    return false;
  }

  /// Largest |dev tau| at pressure p.
  template <class S>
  static REND_LAW_INLINE S shear_bound(const S* c, S p, S p0) {
    return c[kSlope] * sqrt(max((p + c[kBeta] * p0) * (p0 - p), S(0)));
  }

  template <class S>
  static REND_LAW_INLINE S value(const LawConstants<S>& k, const Triple<S>& eps, S p0) {
    const S* c = k.surface;
    const S p = S(0) - c[kBulk] * trace(eps);
    return max(k.mu2 * norm(deviator(eps)) - shear_bound(c, p, p0),
               max(p - p0, S(0) - c[kBeta] * p0 - p));
  }

  template <class S>
  static REND_LAW_INLINE ReturnMap<S> return_map(const LawConstants<S>& k, const Triple<S>& eps,
                                                 S p0) {
    const S* c = k.surface;
    const S zero(0), one(1), half(0.5), tiny(1e-30);
    const S volume = trace(eps);
    const Triple<S> dev = deviator(eps);
    const S length = norm(dev);
    const S p = zero - c[kBulk] * volume;
    const Mask<S> yielded = value(k, eps, p0) > zero;

    // Compaction that hardens: up to the tip, or up to the ellipse along the ray from its centre.
    const S tip = min(max(p, zero - c[kBeta] * p0), p0);
    const S centre = half * (one - c[kBeta]) * p0, radius = half * (one + c[kBeta]) * p0;
    const S across = (p - centre) / max(radius, tiny);
    const S up = k.mu2 * length / max(c[kSlope] * radius, tiny);
    const S reach = sqrt(across * across + up * up);
    const S on_ray = centre + (p - centre) / max(reach, one);
    const Mask<S> at_tip = (p > p0) | (p < zero - c[kBeta] * p0);
    const S compaction = (p - select(at_tip, tip, on_ray)) / c[kBulk];

    // asinh and sinh from what lanes have; the bound keeps p0 finite.
    const S x = p0 / c[kBulk];
    const S a = log1p(x + x * x / (one + sqrt(one + x * x)));
    const S grown = min(max(a + c[kHardening] * compaction, zero), S(7));
    const S e = expm1(grown);
    const S next = c[kBulk] * half * (e + e / (one + e));
    const S moved = select(c[kHardening] * abs(compaction) > zero, next, p0);

    const S cap = min(moved, p0);
    const S pressure = min(max(p, zero - c[kBeta] * cap), cap);
    const S bound = shear_bound(c, pressure, cap) / k.mu2;
    const S kept = min(length, select(pressure < p, zero, select(p < pressure, zero, bound)));
    const S scale = (length - kept) / max(length, tiny);
    const S lost = (pressure - p) / c[kBulk] * S(1.0 / 3);
    Triple<S> plastic;
    for (int i = 0; i < 3; ++i) plastic[i] = select(yielded, dev[i] * scale + lost, zero);
    const S work = k.mu2 * kept * (length - kept) - S(3) * pressure * lost;
    return {plastic, select(yielded, moved, p0), select(yielded, max(work, zero), zero), yielded};
  }
};

REND_LAW_END()

#endif
