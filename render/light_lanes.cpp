// The light's row functions for every instruction set, chosen once at run time.
#include "render/light_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/light_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rend {
namespace HWY_NAMESPACE {

#include "render/lanes-inl.h"

#define REND_LANES HWY_INLINE
#include "render/light_kernels-inl.h"
#undef REND_LANES

LightKernels get_kernels() { return kernel_table(); }
const char* get_target() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace rend
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rend {

HWY_EXPORT(get_kernels);
HWY_EXPORT(get_target);

const LightKernels& lane_light_kernels() {
  static const LightKernels kernels = HWY_DYNAMIC_DISPATCH(get_kernels)();
  return kernels;
}

const char* lane_light_target() { return HWY_DYNAMIC_DISPATCH(get_target)(); }

}  // namespace rend
#endif
