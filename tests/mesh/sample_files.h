// Small mesh files written by the tests themselves.
#pragma once

#include "engine/mesh/triangle_surface.h"

#include <string>

namespace rend {

/// A cube of side 1 at `low`, 12 outward triangles.
TriangleSurface cube_surface(const Vec3& low = Vec3::Zero(), Real side = 1);
/// Both surfaces as one.
TriangleSurface merged(const TriangleSurface& a, const TriangleSurface& b);

std::string as_obj(const TriangleSurface& surface);
std::string as_stl(const TriangleSurface& surface);  ///< text form
std::string as_ply(const TriangleSurface& surface);  ///< text form
std::string as_off(const TriangleSurface& surface);

}  // namespace rend
