// Bounding volume hierarchy over triangles: distance and winding number.
#pragma once

#include "engine/mesh/triangle_surface.h"

namespace rend {

/// Keeps a reference to the surface, which must outlive it.
class TriangleBvh {
 public:
  explicit TriangleBvh(const TriangleSurface& surface);

  /// Distance to the nearest triangle, or `limit` when all are farther [m].
  Real distance(const Vec3& x, Real limit) const;

  /// Generalised winding number: 1 inside, 0 outside a closed outward surface, in between for open
  /// ones. Far groups of triangles are taken as dipoles (Barill et al. 2018, first order), error
  /// about 0.01.
  Real winding_number(const Vec3& x) const;

 private:
  struct Node {
    Bounds box;
    Vec3 centre = Vec3::Zero();  ///< area-weighted mean of the triangles' centroids
    Vec3 dipole = Vec3::Zero();  ///< sum of area times normal
    Real radius = 0;             ///< of a ball around `centre` with all triangles
    Index first = 0, count = 0;  ///< triangles; inner nodes have children at left and left + 1
    Index left = -1;
  };

  void build(Index node, std::vector<Vec3>& centroids);

  const TriangleSurface& surface_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

/// Closest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
Vec3 closest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// Signed solid angle of a triangle seen from x (Van Oosterom and Strackee 1983), positive from
/// behind.
Real solid_angle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace rend
