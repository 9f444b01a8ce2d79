// Sixteen float lanes on Google Highway: one 512-bit, two 256-bit or four 128-bit vectors, the same
// code for all. Included once per instruction set, after hwy/foreach_target.h; no include guard but
// Highway's toggle.
#if defined(REND_CORE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_CORE_LANES_INL_H_
#undef REND_CORE_LANES_INL_H_
#else
#define REND_CORE_LANES_INL_H_
#endif

#include "hwy/highway.h"

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
#if HWY_TARGET != HWY_SCALAR  // one lane, no 128-bit blocks: the reference solver runs there
namespace rend {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Two vectors that act as one of twice the width.
template <class V>
struct Pair {
  V a, b;
};

template <size_t N, bool Fits = (N * sizeof(float) <= HWY_MAX_BYTES)>
struct Wide {
  using Tag = hn::FixedTag<float, N>;
  using Vec = hn::Vec<Tag>;
  using Mask = hn::Mask<Tag>;
};
template <size_t N>
struct Wide<N, false> {
  using Vec = Pair<typename Wide<N / 2>::Vec>;
  using Mask = Pair<typename Wide<N / 2>::Mask>;
};
template <size_t N>
using WideVec = typename Wide<N>::Vec;

constexpr bool fits(size_t n) { return n * sizeof(float) <= HWY_MAX_BYTES; }

template <size_t N>
HWY_INLINE WideVec<N> wide_load(const float* p) {
  if constexpr (fits(N))
    return hn::Load(typename Wide<N>::Tag(), p);
  else
    return {wide_load<N / 2>(p), wide_load<N / 2>(p + N / 2)};
}
template <size_t N>
HWY_INLINE WideVec<N> wide_load_unaligned(const float* p) {
  if constexpr (fits(N))
    return hn::LoadU(typename Wide<N>::Tag(), p);
  else
    return {wide_load_unaligned<N / 2>(p), wide_load_unaligned<N / 2>(p + N / 2)};
}
template <size_t N>
HWY_INLINE WideVec<N> wide_set(float v) {
  if constexpr (fits(N)) {
    return hn::Set(typename Wide<N>::Tag(), v);
  } else {
    const auto half = wide_set<N / 2>(v);
    return {half, half};
  }
}
template <size_t N>
HWY_INLINE WideVec<N> wide_repeat4(const float* p) {
  if constexpr (fits(N)) {
    return hn::LoadDup128(typename Wide<N>::Tag(), p);
  } else {
    const auto half = wide_repeat4<N / 2>(p);
    return {half, half};
  }
}
template <size_t N>
HWY_INLINE void wide_store(WideVec<N> v, float* p) {
  if constexpr (fits(N)) {
    hn::Store(v, typename Wide<N>::Tag(), p);
  } else {
    wide_store<N / 2>(v.a, p);
    wide_store<N / 2>(v.b, p + N / 2);
  }
}
template <size_t N>
HWY_INLINE void wide_store_unaligned(WideVec<N> v, float* p) {
  if constexpr (fits(N)) {
    hn::StoreU(v, typename Wide<N>::Tag(), p);
  } else {
    wide_store_unaligned<N / 2>(v.a, p);
    wide_store_unaligned<N / 2>(v.b, p + N / 2);
  }
}

// Element-wise operations: the leaf overload is Highway's, the Pair overload recurses.
#define REND_LANES_OPERATOR(op)                                      \
  template <class V>                                                 \
  HWY_INLINE Pair<V> operator op(const Pair<V> x, const Pair<V> y) { \
    return {x.a op y.a, x.b op y.b};                                 \
  }
REND_LANES_OPERATOR(+)
REND_LANES_OPERATOR(-)
REND_LANES_OPERATOR(*)
REND_LANES_OPERATOR(/)
#undef REND_LANES_OPERATOR

#define REND_LANES_1(name, Op)         \
  template <class V>                   \
  HWY_INLINE V name(V x) {             \
    return hn::Op(x);                  \
  }                                    \
  template <class V>                   \
  HWY_INLINE Pair<V> name(Pair<V> x) { \
    return {name(x.a), name(x.b)};     \
  }
#define REND_LANES_2(name, Op)                           \
  template <class V>                                     \
  HWY_INLINE auto name(V x, V y) {                       \
    return hn::Op(x, y);                                 \
  }                                                      \
  template <class V>                                     \
  HWY_INLINE auto name(Pair<V> x, Pair<V> y) {           \
    const auto a = name(x.a, y.a), b = name(x.b, y.b);   \
    return Pair<std::remove_const_t<decltype(a)>>{a, b}; \
  }
#define REND_LANES_3(name, Op)                               \
  template <class V>                                         \
  HWY_INLINE V name(V x, V y, V z) {                         \
    return hn::Op(x, y, z);                                  \
  }                                                          \
  template <class V>                                         \
  HWY_INLINE Pair<V> name(Pair<V> x, Pair<V> y, Pair<V> z) { \
    return {name(x.a, y.a, z.a), name(x.b, y.b, z.b)};       \
  }
REND_LANES_1(wide_sqrt, Sqrt)
REND_LANES_1(wide_round, Round)
REND_LANES_1(wide_floor, Floor)
REND_LANES_1(wide_abs, Abs)
REND_LANES_1(wide_neg, Neg)
REND_LANES_2(wide_max, Max)
REND_LANES_2(wide_min, Min)
REND_LANES_2(wide_less, Lt)
REND_LANES_2(wide_less_equal, Le)
REND_LANES_2(wide_mask_and, And)
REND_LANES_2(wide_mask_or, Or)
REND_LANES_2(wide_copy_sign, CopySign)
REND_LANES_3(wide_mul_add, MulAdd)
REND_LANES_3(wide_neg_mul_add, NegMulAdd)
REND_LANES_3(wide_mul_sub, MulSub)
#undef REND_LANES_1
#undef REND_LANES_2
#undef REND_LANES_3

template <class M>
HWY_INLINE M wide_mask_not(M m) {
  return hn::Not(m);
}
template <class M>
HWY_INLINE Pair<M> wide_mask_not(Pair<M> m) {
  return {wide_mask_not(m.a), wide_mask_not(m.b)};
}
inline constexpr size_t kLeaf = (HWY_MAX_BYTES < 64 ? HWY_MAX_BYTES : 64) / sizeof(float);
HWY_INLINE bool wide_none(Wide<kLeaf>::Mask m) { return hn::AllFalse(Wide<kLeaf>::Tag(), m); }
template <class M>
HWY_INLINE bool wide_none(Pair<M> m) {
  return wide_none(wide_mask_or(m.a, m.b));
}
template <class M, class V>
HWY_INLINE V wide_select(M m, V yes, V no) {
  return hn::IfThenElse(m, yes, no);
}
template <class M, class V>
HWY_INLINE Pair<V> wide_select(Pair<M> m, Pair<V> yes, Pair<V> no) {
  return {wide_select(m.a, yes.a, no.a), wide_select(m.b, yes.b, no.b)};
}
template <class V>
HWY_INLINE V wide_max_all(V x) {
  return hn::MaxOfLanes(hn::DFromV<V>(), x);
}
template <class V>
HWY_INLINE auto wide_max_all(Pair<V> x) {
  return wide_max_all(wide_max(x.a, x.b));
}
template <class V>
HWY_INLINE float wide_first(V x) {
  return hn::GetLane(x);
}

// Integer side of log, exp and floor.
template <class V>
HWY_INLINE void wide_store_int(V v, int32_t* p) {
  const hn::DFromV<V> d;
  const hn::RebindToSigned<decltype(d)> di;
  hn::Store(hn::NearestInt(v), di, p);
}
template <class V>
HWY_INLINE void wide_store_int(Pair<V> v, int32_t* p) {
  wide_store_int(v.a, p);
  wide_store_int(v.b, p + sizeof(V) / sizeof(float));
}
template <class V>
HWY_INLINE void wide_split_exponent(V x, V& mantissa, V& exponent) {
  const hn::DFromV<V> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto bits = hn::BitCast(di, x);
  const auto e =
      hn::ShiftRight<23>(bits - hn::Set(di, 0x3f3504f3));  // mantissa in [sqrt(1/2), sqrt(2))
  exponent = hn::ConvertTo(d, e);
  mantissa = hn::BitCast(d, bits - hn::ShiftLeft<23>(e));
}
template <class V>
HWY_INLINE void wide_split_exponent(Pair<V> x, Pair<V>& mantissa, Pair<V>& exponent) {
  wide_split_exponent(x.a, mantissa.a, exponent.a);
  wide_split_exponent(x.b, mantissa.b, exponent.b);
}
template <class V>
HWY_INLINE V wide_power_of_two(V n) {
  const hn::DFromV<V> d;
  const hn::RebindToSigned<decltype(d)> di;
  return hn::BitCast(d, hn::ShiftLeft<23>(hn::NearestInt(n) + hn::Set(di, 127)));
}
template <class V>
HWY_INLINE Pair<V> wide_power_of_two(Pair<V> n) {
  return {wide_power_of_two(n.a), wide_power_of_two(n.b)};
}
template <class V>
HWY_INLINE V wide_last_of_four(V v) {
  return hn::Broadcast<3>(v);
}
template <class V>
HWY_INLINE Pair<V> wide_last_of_four(Pair<V> v) {
  return {wide_last_of_four(v.a), wide_last_of_four(v.b)};
}
template <class V>
HWY_INLINE void wide_transpose4(V a, V b, V c, V e, V* out) {
  const hn::DFromV<V> d;
  const hn::Repartition<double, decltype(d)> dd;
  const auto t0 = hn::BitCast(dd, hn::InterleaveLower(d, a, b));
  const auto t1 = hn::BitCast(dd, hn::InterleaveUpper(d, a, b));
  const auto t2 = hn::BitCast(dd, hn::InterleaveLower(d, c, e));
  const auto t3 = hn::BitCast(dd, hn::InterleaveUpper(d, c, e));
  out[0] = hn::BitCast(d, hn::InterleaveLower(dd, t0, t2));
  out[1] = hn::BitCast(d, hn::InterleaveUpper(dd, t0, t2));
  out[2] = hn::BitCast(d, hn::InterleaveLower(dd, t1, t3));
  out[3] = hn::BitCast(d, hn::InterleaveUpper(dd, t1, t3));
}
template <class V>
HWY_INLINE void wide_transpose4(Pair<V> a, Pair<V> b, Pair<V> c, Pair<V> e, Pair<V>* out) {
  V low[4], high[4];
  wide_transpose4(a.a, b.a, c.a, e.a, low);
  wide_transpose4(a.b, b.b, c.b, e.b, high);
  for (int i = 0; i < 4; ++i) out[i] = {low[i], high[i]};
}

/// Sixteen floats. Arithmetic is lane by lane; a float converts to sixteen copies of itself.
struct Lanes {
  static constexpr size_t kCount = 16;
  WideVec<16> v;

  Lanes() = default;
  HWY_INLINE Lanes(float all) : v(wide_set<16>(all)) {}
  HWY_INLINE explicit Lanes(WideVec<16> wide) : v(wide) {}
};

/// Sixteen truth values.
struct LaneMask {
  typename Wide<16>::Mask m;
};

HWY_INLINE Lanes operator+(Lanes x, Lanes y) { return Lanes(x.v + y.v); }
HWY_INLINE Lanes operator-(Lanes x, Lanes y) { return Lanes(x.v - y.v); }
HWY_INLINE Lanes operator*(Lanes x, Lanes y) { return Lanes(x.v * y.v); }
HWY_INLINE Lanes operator/(Lanes x, Lanes y) { return Lanes(x.v / y.v); }
HWY_INLINE Lanes operator-(Lanes x) { return Lanes(wide_neg(x.v)); }
HWY_INLINE Lanes& operator+=(Lanes& x, Lanes y) { return x = x + y; }
HWY_INLINE Lanes& operator-=(Lanes& x, Lanes y) { return x = x - y; }
HWY_INLINE Lanes& operator*=(Lanes& x, Lanes y) { return x = x * y; }
HWY_INLINE LaneMask operator<(Lanes x, Lanes y) { return {wide_less(x.v, y.v)}; }
HWY_INLINE LaneMask operator>(Lanes x, Lanes y) { return {wide_less(y.v, x.v)}; }
HWY_INLINE LaneMask operator<=(Lanes x, Lanes y) { return {wide_less_equal(x.v, y.v)}; }
HWY_INLINE LaneMask operator>=(Lanes x, Lanes y) { return {wide_less_equal(y.v, x.v)}; }
HWY_INLINE LaneMask operator&(LaneMask x, LaneMask y) { return {wide_mask_and(x.m, y.m)}; }
HWY_INLINE LaneMask operator|(LaneMask x, LaneMask y) { return {wide_mask_or(x.m, y.m)}; }
HWY_INLINE LaneMask operator!(LaneMask x) { return {wide_mask_not(x.m)}; }
HWY_INLINE bool any(LaneMask x) { return !wide_none(x.m); }

HWY_INLINE Lanes max(Lanes x, Lanes y) { return Lanes(wide_max(x.v, y.v)); }
HWY_INLINE Lanes min(Lanes x, Lanes y) { return Lanes(wide_min(x.v, y.v)); }
HWY_INLINE Lanes abs(Lanes x) { return Lanes(wide_abs(x.v)); }
HWY_INLINE Lanes sqrt(Lanes x) { return Lanes(wide_sqrt(x.v)); }
HWY_INLINE Lanes floor(Lanes x) { return Lanes(wide_floor(x.v)); }
HWY_INLINE Lanes round(Lanes x) { return Lanes(wide_round(x.v)); }
/// |magnitude| with the sign of `sign`.
HWY_INLINE Lanes copy_sign(Lanes magnitude, Lanes sign) {
  return Lanes(wide_copy_sign(magnitude.v, sign.v));
}
HWY_INLINE Lanes select(LaneMask m, Lanes yes, Lanes no) {
  return Lanes(wide_select(m.m, yes.v, no.v));
}
/// x y + z, rounded once where the instruction set can.
HWY_INLINE Lanes mul_add(Lanes x, Lanes y, Lanes z) { return Lanes(wide_mul_add(x.v, y.v, z.v)); }
/// z - x y.
HWY_INLINE Lanes neg_mul_add(Lanes x, Lanes y, Lanes z) {
  return Lanes(wide_neg_mul_add(x.v, y.v, z.v));
}
/// x y - z.
HWY_INLINE Lanes mul_sub(Lanes x, Lanes y, Lanes z) { return Lanes(wide_mul_sub(x.v, y.v, z.v)); }

/// Aligned to 64 bytes.
HWY_INLINE Lanes load(const float* p) { return Lanes(wide_load<16>(p)); }
HWY_INLINE Lanes load_unaligned(const float* p) { return Lanes(wide_load_unaligned<16>(p)); }
HWY_INLINE void store(Lanes x, float* p) { wide_store<16>(x.v, p); }
HWY_INLINE void store_unaligned(Lanes x, float* p) { wide_store_unaligned<16>(x.v, p); }
/// Rounds to the nearest integer.
HWY_INLINE void store_int(Lanes x, int32_t* p) { wide_store_int(x.v, p); }
/// p[0..3], four times.
HWY_INLINE Lanes repeat4(const float* p) { return Lanes(wide_repeat4<16>(p)); }

/// Eight floats: half a row of nodes.
HWY_INLINE void copy8(const float* from, float* to) { wide_store<8>(wide_load<8>(from), to); }
HWY_INLINE void copy8_unaligned(const float* from, float* to) {
  wide_store_unaligned<8>(wide_load_unaligned<8>(from), to);
}
HWY_INLINE void add8(const float* from, float* to) {
  wide_store<8>(wide_load<8>(to) + wide_load<8>(from), to);
}

HWY_INLINE float max_of_lanes(Lanes x) { return wide_first(wide_max_all(x.v)); }
HWY_INLINE float sum_of_lanes(Lanes x) {
  alignas(64) float all[16];
  store(x, all);
  float sum = 0;
  for (const float one : all) sum += one;  // one order on every instruction set
  return sum;
}

/// The last of every four lanes, four times.
HWY_INLINE Lanes last_of_four(Lanes x) { return Lanes(wide_last_of_four(x.v)); }
/// 4 x 4 transpose inside every group of four lanes: out[r][4 q + c] = in[c][4 q + r].
HWY_INLINE void transpose4(Lanes a, Lanes b, Lanes c, Lanes d, Lanes* out) {
  WideVec<16> t[4];
  wide_transpose4(a.v, b.v, c.v, d.v, t);
  for (int i = 0; i < 4; ++i) out[i] = Lanes(t[i]);
}

alignas(64) static constexpr float kGroupIndex[16] = {0, 0, 0, 0, 1, 1, 1, 1,
                                                      2, 2, 2, 2, 3, 3, 3, 3};
alignas(64) static constexpr uint8_t kSpreadBytes[64] = {
    0, 1, 2,  3,  0,  1,  2,  3,  0,  1,  2,  3,  0,  1,  2,  3,  4,  5,  6,  7, 4,  5,
    6, 7, 4,  5,  6,  7,  4,  5,  6,  7,  8,  9,  10, 11, 8,  9,  10, 11, 8,  9, 10, 11,
    8, 9, 10, 11, 12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15};
alignas(64) static constexpr uint32_t kLastOfFour[16] = {0, 0, 0, ~0u, 0, 0, 0, ~0u,
                                                         0, 0, 0, ~0u, 0, 0, 0, ~0u};

/// 0 0 0 0 1 1 1 1 2 2 2 2 3 3 3 3.
HWY_INLINE Lanes group_index() { return load(kGroupIndex); }

#if HWY_MAX_BYTES >= 64
/// p[0] four times, then p[1], p[2], p[3].
HWY_INLINE Lanes spread4(const float* p) {
  const hn::FixedTag<float, 16> d;
  const hn::FixedTag<uint8_t, 64> d8;
  return Lanes(hn::BitCast(
      d, hn::TableLookupBytes(hn::BitCast(d8, hn::LoadDup128(d, p)), hn::Load(d8, kSpreadBytes))));
}
/// What a part of a row needs of spread4: all of it, or with 128-bit vectors one number.
HWY_INLINE WideVec<16> spread_part(const float* p, int) { return spread4(p).v; }
/// Group r of the result is the sum of the four groups of argument r.
HWY_INLINE Lanes sum_groups(Lanes r0, Lanes r1, Lanes r2, Lanes r3) {
  const hn::FixedTag<float, 16> d;
  const auto a = hn::ConcatLowerLower(d, r2.v, r0.v) + hn::ConcatUpperUpper(d, r2.v, r0.v);
  const auto b = hn::ConcatLowerLower(d, r3.v, r1.v) + hn::ConcatUpperUpper(d, r3.v, r1.v);
  return Lanes(hn::OddEvenBlocks(b, a) + hn::SwapAdjacentBlocks(hn::OddEvenBlocks(a, b)));
}
/// a[0..3], b[0..3], c[0..3], e[0..3].
HWY_INLINE Lanes concat4(const float* a, const float* b, const float* c, const float* e) {
  const hn::FixedTag<float, 4> d4;
  const hn::FixedTag<float, 8> d8;
  const hn::FixedTag<float, 16> d;
  return Lanes(hn::Combine(d, hn::Combine(d8, hn::Load(d4, e), hn::Load(d4, c)),
                           hn::Combine(d8, hn::Load(d4, b), hn::Load(d4, a))));
}
/// First three of every four lanes of x, the last from y.
HWY_INLINE Lanes replace_last_of_four(Lanes x, Lanes y) {
  const hn::FixedTag<float, 16> d;
  const auto mask = hn::BitCast(d, hn::Load(hn::FixedTag<uint32_t, 16>(), kLastOfFour));
  return Lanes(hn::IfThenElse(hn::MaskFromVec(mask), y.v, x.v));
}
#elif HWY_MAX_BYTES == 32
HWY_INLINE Lanes spread4(const float* p) {
  const hn::FixedTag<float, 8> d;
  const hn::FixedTag<uint8_t, 32> d8;
  const auto t = hn::BitCast(d8, hn::LoadDup128(d, p));
  return Lanes({hn::BitCast(d, hn::TableLookupBytes(t, hn::Load(d8, kSpreadBytes))),
                hn::BitCast(d, hn::TableLookupBytes(t, hn::Load(d8, kSpreadBytes + 32)))});
}
HWY_INLINE WideVec<16> spread_part(const float* p, int) { return spread4(p).v; }
HWY_INLINE Lanes sum_groups(Lanes r0, Lanes r1, Lanes r2, Lanes r3) {
  const hn::FixedTag<float, 8> d;
  const auto s0 = r0.v.a + r0.v.b, s1 = r1.v.a + r1.v.b;
  const auto s2 = r2.v.a + r2.v.b, s3 = r3.v.a + r3.v.b;
  return Lanes({hn::ConcatUpperLower(d, s1, s0) + hn::ConcatLowerUpper(d, s1, s0),
                hn::ConcatUpperLower(d, s3, s2) + hn::ConcatLowerUpper(d, s3, s2)});
}
HWY_INLINE Lanes concat4(const float* a, const float* b, const float* c, const float* e) {
  const hn::FixedTag<float, 4> d4;
  const hn::FixedTag<float, 8> d;
  return Lanes({hn::Combine(d, hn::Load(d4, b), hn::Load(d4, a)),
                hn::Combine(d, hn::Load(d4, e), hn::Load(d4, c))});
}
HWY_INLINE Lanes replace_last_of_four(Lanes x, Lanes y) {
  const hn::FixedTag<float, 8> d;
  const auto mask =
      hn::MaskFromVec(hn::BitCast(d, hn::Load(hn::FixedTag<uint32_t, 8>(), kLastOfFour)));
  return Lanes({hn::IfThenElse(mask, y.v.a, x.v.a), hn::IfThenElse(mask, y.v.b, x.v.b)});
}
#else
HWY_INLINE Lanes spread4(const float* p) {
  const hn::FixedTag<float, 4> d;
  const auto t = hn::Load(d, p);
  return Lanes(
      {{hn::Broadcast<0>(t), hn::Broadcast<1>(t)}, {hn::Broadcast<2>(t), hn::Broadcast<3>(t)}});
}
HWY_INLINE WideVec<4> spread_part(const float* p, int part) { return wide_set<4>(p[part]); }
HWY_INLINE WideVec<4> sum_quarters(Lanes r) { return (r.v.a.a + r.v.b.a) + (r.v.a.b + r.v.b.b); }
HWY_INLINE Lanes sum_groups(Lanes r0, Lanes r1, Lanes r2, Lanes r3) {
  return Lanes({{sum_quarters(r0), sum_quarters(r1)}, {sum_quarters(r2), sum_quarters(r3)}});
}
HWY_INLINE Lanes concat4(const float* a, const float* b, const float* c, const float* e) {
  const hn::FixedTag<float, 4> d;
  return Lanes({{hn::Load(d, a), hn::Load(d, b)}, {hn::Load(d, c), hn::Load(d, e)}});
}
HWY_INLINE WideVec<4> replace_last(WideVec<4> x, WideVec<4> y) {
  const hn::FixedTag<float, 4> d;
  const auto mask = hn::BitCast(d, hn::Load(hn::FixedTag<uint32_t, 4>(), kLastOfFour));
  return hn::IfThenElse(hn::MaskFromVec(mask), y, x);
}
HWY_INLINE Lanes replace_last_of_four(Lanes x, Lanes y) {
  return Lanes({{replace_last(x.v.a.a, y.v.a.a), replace_last(x.v.a.b, y.v.a.b)},
                {replace_last(x.v.b.a, y.v.b.a), replace_last(x.v.b.b, y.v.b.b)}});
}
#endif

/// log(1 + x) with a small relative error for small x (0.5 ulp below 0.1, 2.5 ulp above); x > -1.
HWY_INLINE Lanes log1p(Lanes x) {
  const Lanes u = Lanes(1.0f) + x;
  const Lanes lost = x - (u - Lanes(1.0f));
  Lanes m, k;
  wide_split_exponent(u.v, m.v, k.v);
  Lanes f = m - Lanes(1.0f);
  f += select(k * k < Lanes(0.5f), lost, Lanes(0.0f));
  const Lanes z = f * f;
  Lanes p = Lanes(7.0376836292e-2f);
  for (const float c : {-1.1514610310e-1f, 1.1676998740e-1f, -1.2420140846e-1f, 1.4249322787e-1f,
                        -1.6668057665e-1f, 2.0000714765e-1f, -2.4999993993e-1f, 3.3333331174e-1f})
    p = mul_add(p, f, Lanes(c));
  const Lanes r = mul_add(z, mul_add(f, p, Lanes(-0.5f)), f);
  return mul_add(k, Lanes(0.693147182f), r);
}

/// exp(x) - 1 with a small relative error for small x (1.4 ulp); |x| < 87.
HWY_INLINE Lanes expm1(Lanes x) {
  const Lanes n = round(x * Lanes(1.44269504f));
  Lanes r = neg_mul_add(n, Lanes(0.693359375f), x);
  r = neg_mul_add(n, Lanes(-2.12194440e-4f), r);
  Lanes p = Lanes(1.9875691500e-4f);
  for (const float c :
       {1.3981999507e-3f, 8.3334519073e-3f, 4.1665795894e-2f, 1.6666665459e-1f, 5.0000001201e-1f})
    p = mul_add(p, r, Lanes(c));
  const Lanes e = mul_add(p, r * r, r);
  const Lanes s = Lanes(wide_power_of_two(n.v));
  return mul_add(s, e, s - Lanes(1.0f));
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
#endif
HWY_AFTER_NAMESPACE();
#endif  // include toggle
