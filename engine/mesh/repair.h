// Raw triangles made into the boundary of a solid.
#pragma once

#include "engine/mesh/triangle_surface.h"

#include <string>

namespace rend {

/// Welds near-equal vertices (1e-6 of the bounding box's diagonal), drops degenerate, duplicate,
/// inner and loose faces, turns faces to agree, closes small holes (up to 100 edges, or shorter
/// than 10 % of the diagonal), turns shells outward (shells inside others that face the other way
/// are cavities) and drops tiny ones. Says what it did in `notes`. The result is closed: every edge
/// is used as often forward as backward.
/// @throws Error with where = "file" and what is wrong and where when no solid can be made of it.
TriangleSurface repair_surface(TriangleSurface surface, std::vector<std::string>& notes);

}  // namespace rend
