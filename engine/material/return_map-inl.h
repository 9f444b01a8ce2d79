// What a return mapping gives back, and the parts that yield surfaces share.
#if defined(REND_MATERIAL_RETURN_MAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_RETURN_MAP_INL_H_
#undef REND_MATERIAL_RETURN_MAP_INL_H_
#else
#define REND_MATERIAL_RETURN_MAP_INL_H_
#endif

#include "engine/material/elasticity-inl.h"
#include "engine/material/law_constants.h"

#include <utility>

REND_LAW_BEGIN()

/// The constants for another scalar, e.g. broadcast to lanes; S is constructible from T.
template <class S, class T>
REND_LAW_INLINE LawConstants<S> convert_constants(const LawConstants<T>& k) {
  LawConstants<S> out;
  out.mu2 = S(k.mu2);
  out.inverse_mu2 = S(k.inverse_mu2);
  out.lambda = S(k.lambda);
  for (int i = 0; i < kMaxSurfaceConstants; ++i) out.surface[i] = S(k.surface[i]);
  out.damage_threshold = S(k.damage_threshold);
  out.damage_mu2 = S(k.damage_mu2);
  out.damage_friction = S(k.damage_friction);
  return out;
}

/// What comparing two S gives.
template <class S>
using Mask = decltype(std::declval<S>() < std::declval<S>());

/// Result of a return mapping; the admissible strain is trial - plastic.
template <class S>
struct ReturnMap {
  Triple<S> plastic;  ///< plastic principal Hencky strain of this step [-]; exactly 0 when elastic
  S tau_c;            ///< threshold after softening [Pa]
  S dissipation;      ///< plastic work per rest volume, >= 0 [J/m3]
  Mask<S> yielded;
};

/// Plastic work per rest volume while the threshold falls linearly from tau_c to `softened`, with
/// plastic strain summing up to `total` and driving softening by `driver` times alpha; work ends
/// when the threshold reaches 0.
template <class S>
REND_LAW_INLINE S softening_work(S tau_c, S softened, S total, S alpha, S driver) {
  const S share = tau_c / max(max(alpha * driver, tau_c), S(1e-30));
  return S(0.5) * (tau_c + softened) * total * share;
}

REND_LAW_END()

#endif
