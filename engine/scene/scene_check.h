// What single fields cannot tell: numbers of a scene that must fit each other.
#pragma once

#include <string>

#include "engine/scene/scene_desc.h"

namespace rend {

/// Turns a clockwise outline round, fills softening from fracture_energy by the crack band
/// alpha = w tau_c^2 / (2 G_f) (Bazant and Oh 1983), and checks shapes, keyframes, camera and time
/// steps. w is the band in which particles localise, 2.3 dx (quadratic) or 3.3 dx (cubic), or one
/// tet edge in mesh mode.
/// @throws Error(source + "#/pointer").
void complete_scene(SceneDesc& scene, const std::string& source);

}  // namespace rend
