// Ambient light on the floor: how much of the sky each place sees past the things above it.
#pragma once

#include "render/corner_mesh.h"
#include "render/view.h"

#include <vector>

namespace rend {

/// Openness in [0, 1] on a square grid over the floor; 1 at the border. Free of the noise and the
/// missing back sides of screen-space occlusion.
struct GroundMap {
  static constexpr int kSize = 256;
  float center_x = 0, center_z = 0;
  float half = 1;  ///< half width [m]
  std::vector<float> open = std::vector<float>(kSize * kSize, 1.0f);
};

/// Cells remember the lowest thing above them. A thing at height h dims the floor around it by the
/// cosine-weighted view factor, about a blur of width h; heights are sorted into three layers, each
/// with a blur of its own.
GroundMap make_ground_map(const CornerMesh& mesh, const std::vector<PointVertex>& points,
                          float point_radius, float floor, const Bounds3f& bounds);

}  // namespace rend
