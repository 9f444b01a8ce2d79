// Where a law lives: in rend in ordinary files, in one namespace per instruction set once Highway
// is included. No include guard on purpose: the macros follow the file that includes a law.
//
// A law file is re-includable (`*-inl.h`, guarded with HWY_TARGET_TOGGLE) and calls only `max, min,
// select, sqrt, abs, log1p, expm1` and operators on its scalar S; comparisons give a mask with `& |
// !`, and S is constructible from a double constant. One source file uses laws either in rend or
// per instruction set, never both.
#undef REND_LAW_BEGIN
#undef REND_LAW_END
#undef REND_LAW_INLINE

#ifdef HWY_NAMESPACE
#define REND_LAW_BEGIN()  \
  HWY_BEFORE_NAMESPACE(); \
  namespace rend {        \
  namespace HWY_NAMESPACE {
#define REND_LAW_END() \
  }                    \
  }                    \
  HWY_AFTER_NAMESPACE();
#define REND_LAW_INLINE HWY_INLINE
#else
#include "engine/core/scalar_ops.h"
#define REND_LAW_BEGIN() namespace rend {
#define REND_LAW_END() }
#define REND_LAW_INLINE inline
#endif
