// The ray of sight through a point of the picture.
#pragma once

#include "render/renderer.h"

namespace rend {

/// Direction of the ray from the eye through (x, y), shares of the picture from its top left; its
/// component along the line of sight is 1. @throws Error as Renderer::draw does for a bad camera.
Vec3 pixel_ray(const Camera& camera, int width, int height, Real x, Real y);

}  // namespace rend
