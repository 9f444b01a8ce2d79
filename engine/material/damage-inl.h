// What is left of matter whose strength is used up: nothing, or tension-free rubble with friction.
#if defined(REND_MATERIAL_DAMAGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_DAMAGE_INL_H_
#undef REND_MATERIAL_DAMAGE_INL_H_
#else
#define REND_MATERIAL_DAMAGE_INL_H_
#endif

#include "engine/material/return_map-inl.h"

REND_LAW_BEGIN()

/// Strain that damaged matter carries elastically, its volume gain tr eps while it is open, and its
/// shear modulus.
template <class S>
struct DamagedState {
  Triple<S> eps;
  S gain;         ///< >= 0 [-]
  S mu2;          ///< [Pa]
  S dissipation;  ///< by friction, per rest volume [J/m3]
};

/// Matter that is never damaged.
struct NoDamage {
  static constexpr bool kActive = false;
  template <class S>
  static REND_LAW_INLINE DamagedState<S> respond(const LawConstants<S>& k, const Triple<S>& eps,
                                                 S gain) {
    return {eps, gain, k.mu2, S(0)};
  }
};

/// Damaged matter carries no stress at all.
struct ZeroDamage {
  static constexpr bool kActive = true;
  template <class S>
  static REND_LAW_INLINE DamagedState<S> respond(const LawConstants<S>& k, const Triple<S>&, S) {
    return {{{S(0), S(0), S(0)}}, S(0), k.mu2, S(0)};
  }
};

/// Damaged matter is rubble: free of stress while its volume is above rest, elastic in compression
/// with the bulk modulus kept, and cohesionless Drucker-Prager in shear, |dev eps| <= friction *
/// (-tr eps), without dilation. The volume gained while open is used up first when it is pressed
/// together again (volume correction as in Tampubolon et al. 2017).
struct GranularDamage {
  static constexpr bool kActive = true;
  template <class S>
  static REND_LAW_INLINE DamagedState<S> respond(const LawConstants<S>& k, const Triple<S>& eps,
                                                 S gain) {
    const S zero(0);
    const S volume = trace(eps) + gain;
    const S mean = volume * S(1.0 / 3);
    const Triple<S> dev = deviator(eps);
    const S length = norm(dev);
    const S bound = max(k.damage_friction * (zero - volume), zero);
    const S scale = min(bound / max(length, S(1e-30)), S(1));
    const Mask<S> open = volume > zero;
    Triple<S> kept;
    for (int i = 0; i < 3; ++i) kept[i] = select(open, zero, dev[i] * scale + mean);
    const S slip = length * (S(1) - scale);
    return {kept, max(volume, zero), k.damage_mu2,
            select(open, zero, k.damage_mu2 * (length * scale) * slip)};
  }
};

REND_LAW_END()

#endif
