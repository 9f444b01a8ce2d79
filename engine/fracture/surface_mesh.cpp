// Measures of a surface.
#include "engine/fracture/surface_mesh.h"

#include <Eigen/Geometry>

namespace rend {

Real enclosed_volume(const SurfaceMesh& mesh) {
  if (mesh.x.empty()) return 0;
  const Vec3 origin = mesh.x.front();
  Real sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += (mesh.x[t[0]] - origin).dot((mesh.x[t[1]] - origin).cross(mesh.x[t[2]] - origin));
  return sum / 6;
}

}  // namespace rend
