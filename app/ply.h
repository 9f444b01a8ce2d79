// Binary PLY of a surface or of particles, with the fields other programs want.
#pragma once

#include "engine/fracture/surface_mesh.h"
#include "engine/mpm/snapshot.h"
#include "engine/scene/model.h"

#include <string>

namespace rend {

/// Little-endian PLY: vertices with x y z, nx ny nz, rest_x.., damage, stress [Pa], speed [m/s]; faces with
/// vertex_indices, interior (1: crack face) and piece. Lengths in metres, y up.
std::string surface_ply(const SurfaceMesh& mesh);

/// Little-endian PLY of points: id, x y z, rest_x.., vx vy vz, damage, stress [Pa], yielded, body.
std::string particles_ply(const Snapshot& snapshot, const Model& model);

}  // namespace rend
