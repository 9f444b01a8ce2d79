// The single steps of surface repair, in the order in which they run.
#pragma once

#include "engine/mesh/triangle_surface.h"

#include <string>

namespace rend {

using Notes = std::vector<std::string>;

/// One vertex for all closer than `tolerance` [m]; unused vertices go, too.
void weld(TriangleSurface& surface, Real tolerance);
/// Drops triangles with a repeated vertex and all but one of equal vertex sets.
void drop_degenerate_and_duplicate(TriangleSurface& surface, Notes& notes);
/// Drops inner walls and loose flaps at edges of three or more triangles.
void drop_loose_patches(TriangleSurface& surface, Notes& notes);
/// Makes neighbours agree on their direction. @throws Error for one-sided surfaces.
void orient(TriangleSurface& surface, Notes& notes);
/// Closes small holes. @throws Error when larger ones remain.
void close_holes(TriangleSurface& surface, Notes& notes);
/// Turns shells outward and drops tiny and doubled ones. @throws Error when nothing with volume is
/// left.
void settle_shells(TriangleSurface& surface, Notes& notes);

/// "near (x, y, z)" in the file's own coordinates.
std::string near_text(const Vec3& x);

/// Labels 0..n-1 of triangles connected by edges that `connects` accepts.
struct TriangleGroups {
  std::vector<Index> label;
  Index count = 0;
};
TriangleGroups connected_triangles(const TriangleSurface& surface, bool only_pairs);

/// Keeps the triangles whose flag is set.
void keep_triangles(TriangleSurface& surface, const std::vector<char>& keep);

}  // namespace rend
