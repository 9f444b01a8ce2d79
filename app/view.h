// What a viewer wants to see of a frame, and the draw list made from it.
#pragma once

#include "app/pipeline.h"
#include "render/renderer.h"

#include <memory>
#include <string>

namespace rend {

/// One viewer's look at the scene; part of the key under which pictures are cached.
struct View {
  Camera camera;
  int width = 1280, height = 720;
  std::string color_by = "damage";  ///< as RenderDesc::color_by
  bool particles = false;
  Theme theme = Theme::light;
  int accumulate = 1;               ///< passes, see DrawOptions
  bool legend = true;               ///< drawn into the picture; the page writes its own from X-Legend

  /// Equal views give equal keys.
  std::string key() const;
};

/// The view a scene asks for.
View default_view(const SceneDesc& scene);

/// Names that color_by may have.
const std::vector<std::string>& color_names();

/// What stays the same for all frames of a run.
struct Stage {
  SceneDesc scene;
  Real floor = 0;    ///< height of the studio floor [m]
  Real spacing = 0;  ///< typical distance of particles [m]
  Real size = 1;     ///< diagonal of all matter at rest [m]
};

/// The floor is where the scene says, else a horizontal plane collider, else just below the matter at rest.
Stage make_stage(const SceneDesc& scene, const Model& model);

/// Radius that particles are drawn with [m].
Real particle_radius(const Stage& stage);

/// A draw list together with the storage it points into.
struct Drawing {
  std::shared_ptr<const SurfaceMesh> surface;
  std::shared_ptr<const PointCloud> points;
  DrawList list;
};

/// Surface or particles, colliders at the frame's time, colours and legend.
Drawing make_drawing(const Stage& stage, const Frame& frame, const View& view);

}  // namespace rend
