// From bodies to particles and tets: surface, samples on and in it, Delaunay, clipped to the solid.
#pragma once

#include "engine/mesh/mesh_import.h"
#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

#include <functional>

namespace rend {

/// Sizes of a model before anything is allocated.
struct ModelEstimate {
  double particles = 0;
  double bytes = 0;  ///< particles, tets, fracture tables and grid
};

/// Called with a stage name and a share 0..1.
using Progress = std::function<void(const char* stage, double share)>;

/// Rough numbers from volumes and dx, computed in double so that 1e12 particles do not overflow.
/// @throws Error when a mesh cannot be read.
ModelEstimate estimate_model(const SceneDesc& scene, const MeshLoading& loading = {});

/// Builds all bodies. @throws Error with the JSON pointer of the body when a shape cannot be
/// filled, and when the estimate exceeds `memory_limit` bytes.
Model build_model(const SceneDesc& scene, double memory_limit = 16e9, const Progress& progress = {},
                  const MeshLoading& loading = {});

}  // namespace rend
