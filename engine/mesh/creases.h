// Sharp edges of a surface as curves.
#pragma once

#include "engine/mesh/triangle_surface.h"

namespace rend {

/// Edges with a dihedral angle beyond this turn [deg] are sharp.
inline constexpr Real crease_angle = 40;

/// A chain of points along a sharp edge, from corner to corner; closed chains do not repeat their
/// first point.
struct CreaseCurve {
  std::vector<Vec3> points;
  bool closed = false;
  Index group = 0;  ///< curves that hang together share it
};

/// Joins sharp edges to curves that end where three or one meet, or where they turn by more than
/// the angle.
std::vector<CreaseCurve> chain_creases(const std::vector<Vec3>& positions,
                                       const std::vector<Edge>& edges);

/// Edges of a closed surface whose two triangles meet at more than the angle.
std::vector<Edge> sharp_edges(const TriangleSurface& surface);

}  // namespace rend
