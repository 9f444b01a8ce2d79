// `rend check`: is this scene right, and how large is it?
#pragma once

#include "engine/scene/scene_desc.h"

namespace rend {

/// Builds the scene's matter and prints particles, memory, time step, solver and seconds per frame. @throws Error.
void check_scene(const SceneDesc& scene);

}  // namespace rend
