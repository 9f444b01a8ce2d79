// An indexed triangle surface: what importers give and solids are made of.
#pragma once

#include "engine/core/types.h"

#include <vector>

namespace rend {

/// Triangles over shared positions; outward when counter-clockwise seen from outside.
struct TriangleSurface {
  std::vector<Vec3> positions;      ///< #V [m]
  std::vector<Triangle> triangles;  ///< #T indices into positions

  Vec3 corner(std::size_t triangle, int k) const {
    return positions[static_cast<std::size_t>(triangles[triangle][static_cast<std::size_t>(k)])];
  }
};

/// Enclosed volume by the divergence theorem, sum of x0 . (x1 x x2) / 6 [m3]; negative when inward.
Real enclosed_volume(const TriangleSurface& surface);
/// Sum of the triangles' areas [m2].
Real surface_area(const TriangleSurface& surface);

/// Axis-aligned box around points.
struct Bounds {
  Vec3 low = Vec3::Constant(1e300);
  Vec3 high = Vec3::Constant(-1e300);
  void add(const Vec3& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  Vec3 size() const { return high - low; }
  Vec3 centre() const { return 0.5 * (low + high); }
};
Bounds bounds_of(const std::vector<Vec3>& positions);

}  // namespace rend
