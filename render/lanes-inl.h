// Lane vocabulary of the light on Highway vectors; included once per instruction set inside its
// namespace. No include guard: each instruction set needs its own copy.

namespace hn = hwy::HWY_NAMESPACE;
using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using F = hn::Vec<FloatTag>;
using I = hn::Vec<IntTag>;
using M = hn::Mask<FloatTag>;

HWY_INLINE int lane_count() { return static_cast<int>(hn::Lanes(FloatTag())); }
HWY_INLINE F num(float a) { return hn::Set(FloatTag(), a); }
HWY_INLINE I whole(std::int32_t a) { return hn::Set(IntTag(), a); }
HWY_INLINE F ramp(float first) { return hn::Iota(FloatTag(), first); }

#define REND_MIXED(op)                                           \
  HWY_INLINE F operator op(F a, float b) { return a op num(b); } \
  HWY_INLINE F operator op(float a, F b) { return num(a) op b; }
REND_MIXED(+)
REND_MIXED(-)
REND_MIXED(*)
REND_MIXED(/)
#undef REND_MIXED

HWY_INLINE F load(const float* p) { return hn::LoadU(FloatTag(), p); }
HWY_INLINE I load(const std::uint32_t* p) {
  return hn::LoadU(IntTag(), reinterpret_cast<const std::int32_t*>(p));
}
HWY_INLINE void store(F a, float* p) { hn::StoreU(a, FloatTag(), p); }
HWY_INLINE void store(I a, std::uint32_t* p) {
  hn::StoreU(a, IntTag(), reinterpret_cast<std::int32_t*>(p));
}
HWY_INLINE F load_even(const float* p) {
  F even, odd;
  hn::LoadInterleaved2(FloatTag(), p, even, odd);
  return even;
}
HWY_INLINE I load_even(const std::uint32_t* p) {
  I even, odd;
  hn::LoadInterleaved2(IntTag(), reinterpret_cast<const std::int32_t*>(p), even, odd);
  return even;
}
HWY_INLINE F gather(const float* base, I index) { return hn::GatherIndex(FloatTag(), base, index); }
HWY_INLINE I gather(const std::int32_t* base, I index) {
  return hn::GatherIndex(IntTag(), base, index);
}
HWY_INLINE I gather(const std::uint32_t* base, I index) {
  return hn::GatherIndex(IntTag(), reinterpret_cast<const std::int32_t*>(base), index);
}

HWY_INLINE F minimum(F a, F b) { return hn::Min(a, b); }
HWY_INLINE F maximum(F a, F b) { return hn::Max(a, b); }
HWY_INLINE I minimum(I a, I b) { return hn::Min(a, b); }
HWY_INLINE I maximum(I a, I b) { return hn::Max(a, b); }
HWY_INLINE F absolute(F a) { return hn::Abs(a); }
HWY_INLINE F with_sign(F size, F sign) { return hn::CopySign(size, sign); }
HWY_INLINE F root(F a) { return hn::Sqrt(a); }
/// 1 / a and 1 / sqrt(a), one Newton step after the estimate; `a` must not be zero.
HWY_INLINE F inverse(F a) {
  const F r = hn::ApproximateReciprocal(a);
  return r * (2.0f - a * r);
}
HWY_INLINE F inverse_root(F a) {
  const F r = hn::ApproximateReciprocalSqrt(a);
  return r * (1.5f - 0.5f * a * r * r);
}

HWY_INLINE I truncate(F a) { return hn::ConvertTo(IntTag(), a); }
HWY_INLINE F real(I a) { return hn::ConvertTo(FloatTag(), a); }
template <int kBits>
HWY_INLINE I shift_right(I a) {
  return hn::ShiftRight<kBits>(a);
}
template <int kBits>
HWY_INLINE I shift_left(I a) {
  return hn::ShiftLeft<kBits>(a);
}

HWY_INLINE M both(M a, M b) { return hn::And(a, b); }
HWY_INLINE M not_(M a) { return hn::Not(a); }
HWY_INLINE bool any(M a) { return !hn::AllFalse(FloatTag(), a); }
HWY_INLINE bool all(M a) { return hn::AllTrue(FloatTag(), a); }
HWY_INLINE F select(M m, F yes, F no) { return hn::IfThenElse(m, yes, no); }
HWY_INLINE I select(M m, I yes, I no) {
  return hn::IfThenElse(hn::RebindMask(IntTag(), m), yes, no);
}
