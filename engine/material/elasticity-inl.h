// St. Venant-Kirchhoff elasticity in principal Hencky strain.
#if defined(REND_MATERIAL_ELASTICITY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_ELASTICITY_INL_H_
#undef REND_MATERIAL_ELASTICITY_INL_H_
#else
#define REND_MATERIAL_ELASTICITY_INL_H_
#endif

#include "engine/material/law_scope.h"

REND_LAW_BEGIN()

/// Three principal values in any order.
template <class S>
struct Triple {
  S v[3];
  REND_LAW_INLINE S& operator[](int i) { return v[i]; }
  REND_LAW_INLINE const S& operator[](int i) const { return v[i]; }
};

template <class S>
REND_LAW_INLINE S trace(const Triple<S>& e) {
  return e[0] + e[1] + e[2];
}

/// eps - tr(eps)/3 1.
template <class S>
REND_LAW_INLINE Triple<S> deviator(const Triple<S>& e) {
  const S mean = trace(e) * S(1.0 / 3);
  return {{e[0] - mean, e[1] - mean, e[2] - mean}};
}

template <class S>
REND_LAW_INLINE S norm(const Triple<S>& e) {
  return sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
}

/// Principal Kirchhoff stress [Pa], tau_i = 2 mu eps_i + lambda tr eps (Wang et al. 2019).
template <class S>
REND_LAW_INLINE Triple<S> principal_stress(S mu2, S lambda, const Triple<S>& eps) {
  const S pressure = lambda * trace(eps);
  return {{mu2 * eps[0] + pressure, mu2 * eps[1] + pressure, mu2 * eps[2] + pressure}};
}

/// Energy per rest volume [J/m3], psi = mu eps : eps + lambda/2 (tr eps)^2.
template <class S>
REND_LAW_INLINE S energy_density(S mu2, S lambda, const Triple<S>& eps) {
  const S t = trace(eps);
  return S(0.5) * (mu2 * (eps[0] * eps[0] + eps[1] * eps[1] + eps[2] * eps[2]) + lambda * (t * t));
}

REND_LAW_END()

#endif
