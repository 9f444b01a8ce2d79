// The OpenGL half of a picture: a thin G-buffer seen from the camera and depth maps seen from
// lights.
#pragma once

#include "render/corner_mesh.h"
#include "render/gbuffer.h"
#include "render/view.h"

#include <memory>
#include <string>

namespace rend {

/// Owns a GL context and the buffers of one set of shapes.
class Raster {
 public:
  explicit Raster(GlBackend backend);  ///< @throws Error with the reason of every backend tried
  ~Raster();

  std::string describe() const;  ///< backend and driver

  /// Sends the shapes to the driver; they stay until the next call.
  void upload(const CornerMesh& mesh, const std::vector<PointVertex>& points, float point_radius);

  void draw(const PerspectiveView& view, GBuffer& out);
  void draw_depth(const LightBox& light, DepthMap& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rend
