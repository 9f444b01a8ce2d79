// The live controls of a scene: one row each, read by the page and applied by the session.
#pragma once

#include "engine/scene/scene_desc.h"

#include <functional>
#include <map>
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

/// Control id -> value.
using ControlValues = std::map<std::string, Real>;

/// Sets the values in `scene`; a material with a fracture_energy gets the softening that its other numbers ask for
/// then. @throws Error, and changes nothing, at /values/ID for an id that is none and a value out of range, and at the
/// material when its stress would snap back.
void set_values(SceneDesc& scene, const std::vector<Control>& controls, const ControlValues& values);

}  // namespace rend
