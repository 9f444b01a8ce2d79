// Tells whether a saved state belongs to a scene.
#pragma once

#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// Hash of what a solver takes from a scene for good: particles, grid and schemes, but not materials and loads,
/// which may change mid-run.
std::uint64_t hash_scene(const SceneDesc& scene, const Model& model);

}  // namespace rend
