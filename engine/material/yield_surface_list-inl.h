// The closed list of yield surfaces: to add one, include its file and name it in YieldSurfaceList.
#if defined(REND_MATERIAL_YIELD_SURFACE_LIST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MATERIAL_YIELD_SURFACE_LIST_INL_H_
#undef REND_MATERIAL_YIELD_SURFACE_LIST_INL_H_
#else
#define REND_MATERIAL_YIELD_SURFACE_LIST_INL_H_
#endif

#include "engine/material/cam_clay-inl.h"
#include "engine/material/drucker_prager-inl.h"
#include "engine/material/elastic-inl.h"
#include "engine/material/rankine-inl.h"
#include "engine/material/rankine_von_mises-inl.h"
#include "engine/material/von_mises-inl.h"

REND_LAW_BEGIN()

template <class... Laws>
struct LawList {
  static constexpr int kCount = sizeof...(Laws);
};

/// The order is the type index of YieldSurface; elastic comes first.
using YieldSurfaceList = LawList<Elastic,          //
                                 Rankine,          //
                                 VonMises,         //
                                 RankineVonMises,  //
                                 DruckerPrager,    //
                                 CamClay>;

/// Law number Type of the list.
template <int Type, class List = YieldSurfaceList>
struct LawAt;
template <int Type, class First, class... Rest>
struct LawAt<Type, LawList<First, Rest...>> : LawAt<Type - 1, LawList<Rest...>> {};
template <class First, class... Rest>
struct LawAt<0, LawList<First, Rest...>> {
  using type = First;
};

/// Calls f(Law{}) with the law of `type`; f is not called for an unknown type.
template <class F, class... Laws>
void with_law(int type, F&& f, LawList<Laws...>) {
  int n = 0;
  (void)((n++ == type && (f(Laws{}), true)) || ...);
}
template <class F>
void with_yield_surface(int type, F&& f) {
  with_law(type, f, YieldSurfaceList{});
}

REND_LAW_END()

#endif
