// FLIP: particles keep their own velocity and take the change of the nodes' from the grid.
#if defined(REND_MPM_TILE_FLIP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MPM_TILE_FLIP_INL_H_
#undef REND_MPM_TILE_FLIP_INL_H_
#else
#define REND_MPM_TILE_FLIP_INL_H_
#endif

#include "engine/mpm/tile_transfer-inl.h"

#include <type_traits>

HWY_BEFORE_NAMESPACE();
#if HWY_TARGET != HWY_SCALAR
namespace rend {
namespace HWY_NAMESPACE {

/// What FLIP needs beside the rest. Node rows hold momenta without the impulse of the next step,
/// which has rows of its own: p / m is the velocity v_i^n that the change counts from.
struct alignas(64) FlipWork : Work {
  float change[kNodeTileFloats];   ///< of the velocities in `velocity`
  float impulse[kNodeTileFloats];  ///< beside the momenta in `nodes`
  Momentum impulse_of[kBatch];
  float changes[kBatch][16][4];  ///< per particle: sum w (v_i - v_i^n)
};

template <bool kFlip>
using WorkOf = std::conditional_t<kFlip, FlipWork, Work>;

/// sum w u of one particle: four parts, one per z node, to be added up.
HWY_INLINE Lanes gather_parts(const float* nodes, const Weights& w, int lane) {
  const float* corner = nodes + std::size_t(w.base[lane]) * 4;
  const Lanes y0(w.wy[0][lane]), y1(w.wy[1][lane]), y2(w.wy[2][lane]);
  Lanes sum;
  for (int i = 0; i < 3; ++i) {
    const float* b = corner + i * kPlane;
    const Lanes plane =
        mul_add(y2, load_unaligned(b + 2 * kNodeRowFloats),
                mul_add(y1, load_unaligned(b + kNodeRowFloats), y0 * load_unaligned(b)));
    const Lanes x(w.wx[i][lane]);
    sum = i == 0 ? x * plane : mul_add(x, plane, sum);
  }
  return sum * spread4(w.wz[lane & 3][lane >> 2]);
}

/// Gathers a whole tile, four particles at a time; pad lanes follow the last particle.
HWY_INLINE void gather_changes(const float* nodes, const Weights& w, int count, float out[16][4]) {
  for (int l = 0; l < 16; l += 4) {
    if (l >= count) {
      store(repeat4(out[count - 1]), out[l]);
      continue;
    }
    const auto parts = [&](int k) HWY_ATTR {
      return gather_parts(nodes, w, l + k < count ? l + k : count - 1);
    };
    store(sum_groups(parts(0), parts(1), parts(2), parts(3)), out[l]);
  }
}

/// Stored velocities become those that steps go on from; pad lanes, whose motion nobody keeps,
/// follow the last particle.
HWY_INLINE void keep_velocity(const float* v, int count, float* own) {
  for (int a = 0; a < 3; ++a, v += kLanes, own += kLanes) {
    store(load(v), own);
    for (int l = count; l < kLanes; ++l) own[l] = own[count - 1];
  }
}

/// v_p <- a (v_p + change) + (1 - a) v, into `own` and v.
HWY_INLINE void blend_flip(float ratio, const float changes[16][4], float* own, Lanes* v) {
  Lanes part[4], change[4];
  for (int r = 0; r < 4; ++r)
    part[r] = concat4(changes[r], changes[4 + r], changes[8 + r], changes[12 + r]);
  transpose4(part[0], part[1], part[2], part[3], change);
  const Lanes flip(ratio), pic(1 - ratio);
  for (int a = 0; a < 3; ++a) {
    float* place = own + a * kLanes;
    v[a] = mul_add(flip, load(place) + change[a], pic * v[a]);
    store(v[a], place);
  }
}

/// Momentum m v of sixteen particles, and the impulse of their stress until the next grid step.
/// Particles carry no C; where vertices of elements would, `kicked`, is the velocity that they gain
/// from their elements in that time.
HWY_INLINE void pack_flip(const StepConstants& step, float density, const float* tile, bool kicked,
                          int t, FlipWork& work) {
  const Lanes V = abs(load(tile + TileLayout::kVolume * kLanes));
  const Lanes mass = Lanes(density) * V, factor = Lanes(step.stress_factor) * V;
  Lanes kick[3], offset[3], A[9], p[4];
  for (int a = 0; a < 3; ++a) {
    offset[a] = load(work.offset[t][a]);
    kick[a] = kicked ? load(work.C[t][a]) : Lanes(0.0f);
  }
  constexpr int symmetric[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
  for (int i = 0; i < 9; ++i) A[i] = factor * load(work.stress[t][symmetric[i]]);
  pack_momentum(mass, kick, A, offset, work.impulse_of[t]);
  transpose4(mass * load(work.v[t][0]), mass * load(work.v[t][1]), mass * load(work.v[t][2]), mass,
             p);
  for (int r = 0; r < 4; ++r) store(p[r], &work.momentum[t].row[0][r][0][0]);
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
#endif
HWY_AFTER_NAMESPACE();
#endif  // include toggle
