// No yield surface: matter that never yields.
#if defined(REND_MATERIAL_ELASTIC_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_ELASTIC_INL_H_
#undef REND_MATERIAL_ELASTIC_INL_H_
#else
#define REND_MATERIAL_ELASTIC_INL_H_
#endif

#include "engine/material/return_map-inl.h"

#include <array>

REND_LAW_BEGIN()

struct Elastic {
  static constexpr const char* kName = "elastic";
  static constexpr std::array<Parameter, 0> kParameters{};
  static constexpr int kThreshold = -1;

  static bool prepare(const Lame&, const Real*, SofteningRule, Real*) { return false; }

  template <class S>
  static REND_LAW_INLINE S value(const LawConstants<S>&, const Triple<S>&, S) {
    return S(-1);
  }

  template <class S>
  static REND_LAW_INLINE ReturnMap<S> return_map(const LawConstants<S>&, const Triple<S>&,
                                                 S tau_c) {
    return {{{S(0), S(0), S(0)}}, tau_c, S(0), S(0) > S(1)};
  }
};

REND_LAW_END()

#endif
