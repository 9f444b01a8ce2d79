// The vector kernels, compiled once per instruction set; the best one is chosen at run time.
#include "engine/mpm/tile_kernel.h"

#include <cstdlib>
#include <cstring>
#include <string>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/mpm/tile_kernel.cpp"
#include "hwy/foreach_target.h"

#include "engine/mpm/tile_island-inl.h"
#include "engine/mpm/tile_mesh-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rend {
namespace HWY_NAMESPACE {

const TileKernels* kernels_of_target() {
#if HWY_TARGET == HWY_SCALAR
  return nullptr;
#else
  static constexpr TileKernels kernels = {
      HWY_MAX_BYTES >= 64   ? "avx512"
      : HWY_MAX_BYTES == 32 ? "avx2"
                            : "sse4",
      {{particle_block<Pass::scatter, false>, particle_block<Pass::fused, false>,
        particle_block<Pass::gather, false>, particle_block<Pass::mesh_scatter, false>,
        particle_block<Pass::mesh_gather, false>},
       {particle_block<Pass::scatter, true>, particle_block<Pass::fused, true>,
        particle_block<Pass::gather, true>, particle_block<Pass::mesh_scatter, true>,
        particle_block<Pass::mesh_gather, true>}},
      {lone_run<Pass::scatter>, lone_run<Pass::fused>, lone_run<Pass::gather>},
      exchange_islands,
      {grid_block<false>, grid_block<true>},
      respond_tiles,
      measure_tiles,
      respond_elements,
      measure_elements};
  return &kernels;
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace rend
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rend {

HWY_EXPORT(kernels_of_target);

namespace {

const TileKernels* kernels_of(std::int64_t targets) {
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  const TileKernels* kernels = HWY_DYNAMIC_DISPATCH(kernels_of_target)();
  hwy::SetSupportedTargetsForTest(0);
  return kernels;
}

}  // namespace

std::vector<const TileKernels*> all_tile_kernels() {
  std::vector<const TileKernels*> all;
  for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1) {
    const TileKernels* kernels = kernels_of(targets & -targets);
    if (kernels && (all.empty() || all.back() != kernels)) all.push_back(kernels);
  }
  return all;
}

const TileKernels* tile_kernels() {
  static const TileKernels* const chosen = [] {
    const std::vector<const TileKernels*> all = all_tile_kernels();
    const char* wanted = std::getenv("REND_SIMD");
    if (!wanted || !*wanted) return all.empty() ? nullptr : all.front();
    for (const TileKernels* kernels : all)
      if (std::strcmp(kernels->name, wanted) == 0) return kernels;
    return static_cast<const TileKernels*>(nullptr);
  }();
  return chosen;
}

}  // namespace rend
#endif
