// Volume, area and bounds of triangle surfaces.
#include "engine/mesh/triangle_surface.h"

#include <Eigen/Geometry>

namespace rend {

Real enclosed_volume(const TriangleSurface& surface) {
  if (surface.positions.empty()) return 0;
  // Relative to a point of the surface: far from the origin the products would cancel badly.
  const Vec3 o = surface.positions.front();
  Real six_volumes = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    six_volumes +=
        (surface.corner(t, 0) - o).dot((surface.corner(t, 1) - o).cross(surface.corner(t, 2) - o));
  return six_volumes / 6;
}

Real surface_area(const TriangleSurface& surface) {
  Real area = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Vec3 a = surface.corner(t, 0);
    area += 0.5 * (surface.corner(t, 1) - a).cross(surface.corner(t, 2) - a).norm();
  }
  return area;
}

Bounds bounds_of(const std::vector<Vec3>& positions) {
  Bounds b;
  for (const Vec3& x : positions) b.add(x);
  return b;
}

}  // namespace rend
