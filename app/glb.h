// Binary glTF 2.0 of a surface or of particles.
#pragma once

#include "app/frame_arrays.h"

#include <string>

namespace rend {

/// Two primitives with materials "skin" and "crack"; POSITION, NORMAL (sharp along creases and
/// rims, where vertices are repeated at the same position), COLOR_0 by damage, and _REST [m],
/// _DAMAGE, _STRESS [Pa], _SPEED [m/s], _PIECE. `time` [s] in the extras of the node.
std::string surface_glb(const SurfaceMesh& mesh, Real time);

/// Points with COLOR_0, _REST, _VELOCITY, _DAMAGE, _STRESS, _YIELDED, _BODY, _ID.
std::string particles_glb(const Snapshot& snapshot, const Model& model);

}  // namespace rend
