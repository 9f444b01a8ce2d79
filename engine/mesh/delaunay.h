// Delaunay tetrahedra of points.
#pragma once

#include "engine/core/types.h"

#include <array>
#include <vector>

namespace rend {

/// Finite cells with positive volume, and their neighbours.
struct DelaunayCells {
  std::vector<Tet> tets;
  std::vector<std::array<Index, 4>>
      neighbours;  ///< across the face opposite vertex k; -1 outside the hull
};

/// Delaunay tetrahedra of all points (exact predicates; equal points are dropped). O(n log n),
/// about 5 us a point. @throws nothing; fewer than four points or flat sets give no cells.
DelaunayCells delaunay(const std::vector<Vec3>& points);

}  // namespace rend
