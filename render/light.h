// Lights a G-buffer: soft shadow, ambient occlusion, studio light, filmic curve, endless floor,
// smooth edges.
#pragma once

#include "render/gbuffer.h"
#include "render/ground_map.h"
#include "render/look.h"
#include "render/renderer.h"
#include "render/view.h"

#include <string>
#include <vector>

namespace rend {

/// The instruction set that lights pictures on this processor, e.g. "AVX3".
std::string light_lanes();

/// Lights one picture. `key` is the depth map of the key light, `ground` the ambient light on the
/// floor. The same bytes for any number of threads.
Image light(const GBuffer& picture, const View& view, const DepthMap& key, const GroundMap& ground,
            const Look& look);

/// The same light, one pixel at a time in double precision: what the lanes are tested against.
Image light_reference(const GBuffer& picture, const View& view, const DepthMap& key,
                      const GroundMap& ground, const Look& look);

/// Sums passes of one still: each has its own sub-pixel shift, point of the key light and direction
/// of the sky.
class LightSum {
 public:
  /// Adds a pass; `sky` is the depth map seen from look.sky_direction and replaces the ambient
  /// occlusion.
  void add(const GBuffer& picture, const View& view, const DepthMap& key, const GroundMap& ground,
           const DepthMap& sky, const Look& look);
  /// The mean of all passes. @throws Error when there was none.
  Image image(const Look& look) const;

 private:
  int width_ = 0, height_ = 0, stride_ = 0, passes_ = 0;
  std::vector<float>
      planes_;  ///< mesh red, green, blue, coverage; floor ambient, floor key; each stride * height
};

}  // namespace rend
