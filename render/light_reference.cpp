// The light in double precision, one pixel at a time: the yardstick of the lanes.
#include "render/light_kernels.h"

#include <algorithm>
#include <cmath>

namespace rend {
namespace reference {

using F = double;
using I = std::int32_t;
using M = bool;

int lane_count() { return 1; }
F num(float a) { return a; }
I whole(std::int32_t a) { return a; }
F ramp(float first) { return first; }
F load(const float* p) { return *p; }
I load(const std::uint32_t* p) { return static_cast<I>(*p); }
void store(F a, float* p) { *p = static_cast<float>(a); }
void store(I a, std::uint32_t* p) { *p = static_cast<std::uint32_t>(a); }
F load_even(const float* p) { return *p; }
I load_even(const std::uint32_t* p) { return static_cast<I>(*p); }
F gather(const float* base, I index) { return base[index]; }
I gather(const std::int32_t* base, I index) { return base[index]; }
I gather(const std::uint32_t* base, I index) { return static_cast<I>(base[index]); }
F minimum(F a, F b) { return std::min(a, b); }
F maximum(F a, F b) { return std::max(a, b); }
I minimum(I a, I b) { return std::min(a, b); }
I maximum(I a, I b) { return std::max(a, b); }
F absolute(F a) { return std::abs(a); }
F with_sign(F size, F sign) { return std::copysign(size, sign); }
F root(F a) { return std::sqrt(a); }
F inverse(F a) { return 1 / a; }
F inverse_root(F a) { return 1 / std::sqrt(a); }
I truncate(F a) { return static_cast<I>(a); }
F real(I a) { return a; }
template <int kBits>
I shift_right(I a) {
  return a >> kBits;
}
template <int kBits>
I shift_left(I a) {
  return a << kBits;
}
M both(M a, M b) { return a && b; }
M not_(M a) { return !a; }
bool any(M a) { return a; }
bool all(M a) { return a; }
F select(M m, F yes, F no) { return m ? yes : no; }
I select(M m, I yes, I no) { return m ? yes : no; }

#define REND_LANES static inline
#include "render/light_kernels-inl.h"
#undef REND_LANES

}  // namespace reference

const LightKernels& reference_light_kernels() {
  static const LightKernels kernels = reference::kernel_table();
  return kernels;
}

}  // namespace rend
