// Lights a G-buffer: soft shadow, ambient occlusion, studio light, filmic curve, endless floor,
// smooth edges.
#pragma once

#include "render/gbuffer.h"
#include "render/ground_map.h"
#include "render/look.h"
#include "render/renderer.h"
#include "render/view.h"

#include <memory>
#include <string>
#include <vector>

namespace rend {

/// The instruction set that lights pictures on this processor, e.g. "AVX3".
std::string light_lanes();

/// Lights pictures and stills, and keeps its working planes from one to the next.
class LightPlanes {
 public:
  enum class Arithmetic { lanes, reference };

  /// `reference` works one pixel at a time in double precision: what the lanes are tested against.
  explicit LightPlanes(Arithmetic arithmetic = Arithmetic::lanes);
  ~LightPlanes();

  /// Lights one picture. `key` is the depth map of the key light, `ground` the ambient light on the
  /// floor. The same bytes for any number of threads.
  Image light(const GBuffer& picture, const PerspectiveView& view, const DepthMap& key,
              const GroundMap& ground, const Look& look);

  /// Adds a pass of a still; each has its own sub-pixel shift and point of the key light. With
  /// `sky`, the depth map seen from look.sky_direction, that direction alone lights the surfaces
  /// and takes the place of the ambient occlusion: exact in the limit, but it needs some dozens of
  /// passes.
  void add_pass(const GBuffer& picture, const PerspectiveView& view, const DepthMap& key,
                const GroundMap& ground, const DepthMap* sky, const Look& look);
  /// The mean of all passes since the last still. @throws Error when there was none.
  Image finish_still(const Look& look);

 private:
  struct State;
  std::unique_ptr<State> state_;
  int passes_ = 0;
  std::vector<float>
      sums_;  ///< mesh red, green, blue, coverage; floor ambient, floor key; each stride * height
};

}  // namespace rend
