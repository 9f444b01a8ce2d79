// Particles that share no node with any other: their grid step has a closed form.
#if defined(REND_MPM_TILE_LONE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef REND_MPM_TILE_LONE_INL_H_
#undef REND_MPM_TILE_LONE_INL_H_
#else
#define REND_MPM_TILE_LONE_INL_H_
#endif

#include "engine/mpm/tile_particles-inl.h"

HWY_BEFORE_NAMESPACE();
#if HWY_TARGET != HWY_SCALAR
namespace rend {
namespace HWY_NAMESPACE {

/// C <- keep C + swap C^T + stress_factor / density tau: the velocity gradient that the nodes of a
/// lone particle will have, because every one of them gets w m (v + C r) - w dt V 4 / dx^2 tau r
/// over w m.
HWY_INLINE void kick_lone(const StepConstants& step, float density, float* motion, int t,
                          const Work& work) {
  const Lanes keep(step.affine_keep), swap(step.affine_swap), impulse(step.stress_factor / density);
  Lanes C[9];
  for (int i = 0; i < 9; ++i) C[i] = load(motion + (3 + i) * kLanes);
  constexpr int symmetric[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const int i = 3 * a + b;
      const Lanes affine = mul_add(swap, C[3 * b + a], keep * C[i]);
      store(mul_add(impulse, load(work.stress[t][symmetric[i]]), affine),
            motion + (3 + i) * kLanes);
    }
}

/// v <- v + dt g, x <- x + dt v, strain pushed forward with C.
HWY_INLINE void move_lone(const StepConstants& step, const float* gain, float* tile, float* motion,
                          LaneExtremes& extremes) {
  const Lanes dt(step.dt);
  Lanes v[3], C[9];
  for (int a = 0; a < 3; ++a) {
    v[a] = load(motion + a * kLanes) + Lanes(gain[a]);
    store(v[a], motion + a * kLanes);
    float* place = tile + (TileLayout::kPosition + a) * kLanes;
    store(mul_add(dt, v[a], load(place)), place);
  }
  for (int i = 0; i < 9; ++i) C[i] = load(motion + (3 + i) * kLanes);
  extremes.add(v, C);
  push_strain(dt, C, tile);
}

template <Pass kPass>
HWY_NOINLINE void lone_run(const StepConstants& step, const ParticleRun& run, const float* gain,
                           RunExtremes& out) {
  const FlushDenormals flush;
  static thread_local Work work;
  const MaterialConstants& material = *run.material;
  const int tile_floats = step.layout.floats();
  out = RunExtremes{};
  LaneExtremes extremes;
  for (int first = 0; first < run.count; first += kBatch * kLanes) {
    const int count = run.count - first < kBatch * kLanes ? run.count - first : kBatch * kLanes;
    const int tiles = (count + kLanes - 1) / kLanes;
    float* const begin = run.tiles + std::size_t(first / kLanes) * tile_floats;
    float* const motion = run.motion + std::size_t(first / kLanes) * kMotionFloats;
    if constexpr (kPass == Pass::scatter) {
      stress_batch(material, step.layout, begin, tiles, work);
    } else {
      for (int t = 0; t < tiles; ++t)
        move_lone(step, gain, begin + t * tile_floats, motion + t * kMotionFloats, extremes);
      respond_function(material.response)(material, step.layout, begin, tiles, work, out);
    }
    for (int t = 0; t < tiles; ++t) {
      float* moves = motion + t * kMotionFloats;
      if constexpr (kPass == Pass::gather) {
        Lanes C[9];
        for (int i = 0; i < 9; ++i) C[i] = load(moves + (3 + i) * kLanes);
        store_carried(step, C, moves);
      } else {
        kick_lone(step, material.density, moves, t, work);
      }
    }
  }
  extremes.reduce(out);
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
#endif
HWY_AFTER_NAMESPACE();
#endif  // include toggle
