// What the rasteriser hands to the light: one depth and one packed surface word a pixel, and depth
// maps of lights.
#pragma once

#include "engine/core/types.h"

#include <cstdint>
#include <vector>

namespace rend {

/// Lanes of the light may read and write this many pixels past the end of a row.
constexpr int kLanePad = 16;
constexpr int padded(int width) { return (width + kLanePad - 1) / kLanePad * kLanePad; }

enum class Kind : std::uint32_t { skin = 0, crack = 1, prop = 2, particle = 3 };

/// Rows from the top. `depth` is the window depth of GL, 1 where nothing was drawn. `surface` packs
/// an octahedral normal (bits 0-10, 11-21), the Kind (22-23) and the field value (24-31).
struct GBuffer {
  int width = 0, height = 0, stride = 0;
  std::vector<float> depth;
  std::vector<std::uint32_t> surface;

  void resize(int w, int h) {
    width = w, height = h, stride = padded(w);
    const std::size_t cells =
        static_cast<std::size_t>(stride) * static_cast<std::size_t>(h) + kLanePad;
    depth.resize(cells, 1.0f);
    surface.resize(cells, 0u);
  }
};

/// An orthographic view along -direction: columns `u`, `v` span the map, which covers center +-
/// half extents.
struct LightBox {
  Vec3f direction;  ///< unit, towards the light
  Vec3f u, v;       ///< unit, span the map
  Vec3f center;
  float half = 1;   ///< half width of the map [m]
  float depth = 1;  ///< half depth [m]; map depth 0 is nearest to the light
};

/// size x size window depths seen from a light, 1 where nothing was drawn.
struct DepthMap {
  LightBox box;
  int size = 0;
  std::vector<float> depth;
};

}  // namespace rend
