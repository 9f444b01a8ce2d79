// Summaries of a depth map that spare the light most of its texels.
#pragma once

#include "render/light_kernels.h"

#include <vector>

namespace rend {

/// Nearest depth of every tile of kTile x kTile texels and its eight neighbours.
void nearest_tiles(const DepthMap& map, std::vector<float>& wide);

/// Blurred silhouettes of the casters, for shadows on the floor.
struct Silhouettes {
  std::vector<float> mask, blocker, near, scratch;
  ShadowLevels levels{};  ///< points into the vectors

  void build(const DepthMap& map);
};

}  // namespace rend
