// The live controls of a scene: one row each, read by the page and applied by the session.
#pragma once

#include "engine/scene/scene_desc.h"

#include <functional>
#include <string>
#include <vector>

namespace rend {

/// When a change takes effect.
enum class Applies { live, postprocess };

/// One number that a viewer may change, read from and written to any scene of the same shape.
struct Control {
  std::string id;  ///< JSON pointer in the scene file
  std::string label, unit, help, group;
  Real min = 0, max = 1;
  bool logarithmic = false;
  bool hero = false;  ///< shown first and large
  Applies applies = Applies::live;
  bool whole = false;  ///< whole numbers only
  std::function<Real(const SceneDesc&)> get = {};
  std::function<void(SceneDesc&, Real)> set = {};
};

/// Controls of a scene in the order in which the page shows them: material numbers, gravity, fracture.
std::vector<Control> make_controls(const SceneDesc& scene);

}  // namespace rend
