// The whole response of a material point in principal Hencky strain: yield surface, softening,
// damage, stress.
#if defined(REND_MATERIAL_MATERIAL_LAW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_MATERIAL_LAW_INL_H_
#undef REND_MATERIAL_MATERIAL_LAW_INL_H_
#else
#define REND_MATERIAL_MATERIAL_LAW_INL_H_
#endif

#include "engine/material/damage-inl.h"
#include "engine/material/yield_surface_list-inl.h"

REND_LAW_BEGIN()

/// What a step makes of a trial strain.
template <class S>
struct MaterialResponse {
  Triple<S> eps;     ///< elastic principal Hencky strain [-]
  Triple<S> change;  ///< eps - trial, exactly 0 for an elastic step [-]
  Triple<S> stress;  ///< principal Kirchhoff stress [Pa]
  S tau_c;           ///< new state; see material_response
  S mu2;             ///< 2 mu in force [Pa]
  S dissipation;     ///< energy per rest volume let go in this step, >= 0 [J/m3]
  Mask<S> yielded;   ///< yielded in this step, or is damaged
  Mask<S> damaged;
};

/// Response to a trial strain. The state of a particle is one number: its threshold tau_c [Pa]
/// while intact, and minus the volume it gained (tr eps >= 0) once damaged, so with damage on
/// `tau_c <= 0` means damaged. tau_c0 is the particle's initial threshold. Damage is irreversible.
template <class Law, class Damage, class S>
REND_LAW_INLINE MaterialResponse<S> material_response(const LawConstants<S>& k,
                                                      const Triple<S>& trial, S tau_c, S tau_c0) {
  const S zero(0);
  const ReturnMap<S> map = Law::return_map(k, trial, max(tau_c, zero));
  MaterialResponse<S> out;
  for (int i = 0; i < 3; ++i) {
    out.change[i] = zero - map.plastic[i];
    out.eps[i] = trial[i] - map.plastic[i];
  }
  out.tau_c = map.tau_c;
  out.mu2 = k.mu2;
  out.dissipation = map.dissipation;
  out.yielded = map.yielded;
  out.damaged = zero > S(1);
  if constexpr (Damage::kActive) {
    const Mask<S> was = !(tau_c > zero);
    const Mask<S> now = was | !(map.tau_c > k.damage_threshold * tau_c0);
    Triple<S> start;
    for (int i = 0; i < 3; ++i) start[i] = select(was, trial[i], out.eps[i]);
    const DamagedState<S> rubble = Damage::respond(k, start, select(was, zero - tau_c, zero));
    const S let_go = max(
        energy_density(k.mu2, k.lambda, start) - energy_density(rubble.mu2, k.lambda, rubble.eps),
        zero);
    for (int i = 0; i < 3; ++i) {
      out.eps[i] = select(now, rubble.eps[i], out.eps[i]);
      out.change[i] = select(now, rubble.eps[i] - trial[i], out.change[i]);
    }
    out.tau_c = select(now, zero - rubble.gain, out.tau_c);
    out.mu2 = select(now, rubble.mu2, out.mu2);
    out.dissipation =
        select(was, rubble.dissipation, select(now, map.dissipation + let_go, map.dissipation));
    out.yielded = out.yielded | now;
    out.damaged = now;
  }
  out.stress = principal_stress(out.mu2, k.lambda, out.eps);
  return out;
}

/// Calls f(Law{}, Damage{}) for a type of YieldSurface and of DamageType; a surface without a
/// threshold is never damaged.
template <class F>
void with_material_law(int surface, int damage, F&& f) {
  with_yield_surface(surface, [&](auto law) {
    if constexpr (decltype(law)::kThreshold < 0) {
      f(law, NoDamage{});
    } else {
      if (damage == 0) f(law, NoDamage{});
      if (damage == 1) f(law, ZeroDamage{});
      if (damage == 2) f(law, GranularDamage{});
    }
  });
}

REND_LAW_END()

#endif
