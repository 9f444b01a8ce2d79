// The ray of sight through a point of the picture.
#include "render/pixel_ray.h"

#include "render/view.h"

namespace rend {

Vec3 pixel_ray(const Camera& camera, int width, int height, Real x, Real y) {
  const PerspectiveView view = make_view(camera, width, height, Bounds3f());
  const Vec3 right = view.right.cast<Real>(), up = view.up.cast<Real>();
  return view.forward.cast<Real>() + (2 * x - 1) * view.tan_x * right +
         (1 - 2 * y) * view.tan_y * up;
}

}  // namespace rend
