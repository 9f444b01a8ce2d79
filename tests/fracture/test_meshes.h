// Small tet meshes and motions that the fracture tests are run on.
#pragma once

#include "engine/fracture/crack_mesh.h"
#include "engine/fracture/fracture_mesh.h"
#include "engine/mpm/snapshot.h"
#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

#include <functional>

namespace rend {

/// [0, size] cut into n cells along each axis and each cell into 6 tets; inner particles moved by
/// up to `jitter` cells.
Model kuhn_box(const Vec3i& cells, const Vec3& size, Real jitter, std::uint64_t seed);

/// [0, 1]^3 of n^3 body-centred cubic cells.
Model bcc_cube(int cells);

/// Boundary faces of the tets, outward; total rest volume of the tets.
std::vector<Triangle> boundary_of(const Model& model);
Real rest_volume(const Model& model);

/// One elastic material that can be softened, nothing else.
SceneDesc plain_scene();

/// Everything damaged, so that the gap test looks everywhere; positions by `place(X)`.
Snapshot moved(const Model& model, const std::function<Vec3(const Vec3&)>& place, Index frame = 0,
               float damage = 1);

/// A table that breaks `edges` in frame 0.
BreakTable table_of(const std::vector<Edge>& edges);

/// All edges of the tets, lower particle first, sorted.
std::vector<Edge> edges_of(const Model& model);

/// Edges whose ends have different labels.
std::vector<Edge> edges_between(const Model& model, const std::function<int(const Vec3&)>& label);

}  // namespace rend
