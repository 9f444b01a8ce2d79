// Torn bodies made by formula, to measure and test the renderer without a simulation.
#pragma once

#include "engine/fracture/surface_mesh.h"
#include "render/renderer.h"

namespace rend {

/// Two necked halves of a torus of radius 1 m, pulled apart; about `triangles` triangles, closed,
/// on the floor y = 0.
SurfaceMesh torn_torus(int triangles);

/// A square bar of 2 m length torn in the middle; spans x, floats above y = 0.
SurfaceMesh torn_bar(int triangles);

/// The two blocks that pull the torn bar.
std::vector<Prop> bar_grips();

/// A sphere with `rings` rings of triangles.
SurfaceMesh sphere_surface(const Vec3& center, Real radius, int rings);

}  // namespace rend
