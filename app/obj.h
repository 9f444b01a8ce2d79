// Wavefront OBJ of a surface or of particles, and the two materials it names.
#pragma once

#include "app/frame_arrays.h"

#include <string>

namespace rend {

/// Vertices, corner normals (sharp along creases and crack rims), texture coordinates u = damage,
/// v = stress / largest stress; one group per piece and kind ("piece_3_skin", "piece_3_crack") with
/// material "skin" or "crack". Rest positions and speeds do not fit into OBJ.
std::string surface_obj(const SurfaceMesh& mesh, Real time);

/// Points with texture coordinates as above.
std::string particles_obj(const Snapshot& snapshot);

/// Name and content of the material file that surfaces refer to.
inline constexpr const char* kMaterialFile = "materials.mtl";
std::string obj_materials();

}  // namespace rend
