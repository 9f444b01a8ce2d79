// Materials inside a state file: they may have changed since the scene was read.
#pragma once

#include "engine/mpm/state_file.h"
#include "engine/scene/scene_desc.h"

namespace rend {

void put_material(StateWriter& out, const MaterialDesc& material);

/// The saved numbers under the name of `named`.
MaterialDesc get_material(StateReader& in, const MaterialDesc& named);

}  // namespace rend
