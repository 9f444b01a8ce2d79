// Triangles of a collider, so that one sees what pulls.
#pragma once

#include "engine/scene/motion.h"
#include "render/renderer.h"

#include <optional>

namespace rend {

/// World-space triangles of a visible collider at a time [s]; nothing for planes, hidden and released colliders.
std::optional<Prop> make_prop(const ColliderDesc& collider, Real time);

}  // namespace rend
