// Light set-up and colours of both themes.
#include "render/look.h"

#include "render/color_map.h"

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

/// Direction given by components to the right of the camera, up, and back towards the camera.
Vec3f studio_direction(const PerspectiveView& view, float right, float up, float back) {
  Vec3f toward(-view.forward.x(), 0, -view.forward.z());
  // Straight from above the azimuth is that of the picture's lower edge.
  if (toward.norm() < 1e-3f) toward = Vec3f(-view.up.x(), 0, -view.up.z());
  if (toward.norm() < 1e-3f) toward = Vec3f(0, 0, 1);
  toward.normalize();
  const Vec3f side = Vec3f(0, 1, 0).cross(toward);
  return (right * side + Vec3f(0, up, 0) + back * toward).normalized();
}

Rgb scaled(const Rgb& c, float s) { return {c[0] * s, c[1] * s, c[2] * s}; }

}  // namespace

Look make_look(const DrawList& list, const PerspectiveView& view, const Vec3f& center,
               float radius) {
  Look look;
  const bool dark = list.theme == Theme::dark;
  look.key_direction = studio_direction(view, 0.68f, 1.0f, 0.55f);
  look.rim_direction = studio_direction(view, -0.63f, 0.40f, -0.73f);
  look.sky_direction = Vec3f(0, 1, 0);
  look.key = dark ? Rgb{1.80f, 1.66f, 1.44f} : Rgb{1.95f, 1.79f, 1.53f};
  look.rim = dark ? Rgb{0.42f, 0.50f, 0.62f} : Rgb{0.34f, 0.40f, 0.48f};
  look.sky = dark ? Rgb{0.24f, 0.27f, 0.32f} : Rgb{0.40f, 0.42f, 0.46f};
  look.bounce = dark ? Rgb{0.075f, 0.075f, 0.08f} : Rgb{0.25f, 0.23f, 0.205f};
  look.fill = dark ? Rgb{0.10f, 0.10f, 0.10f} : Rgb{0.20f, 0.19f, 0.175f};
  look.exposure = 0.78f;
  look.backdrop_center = hex_color(dark ? 0x2e3339 : 0xf7f7f6);
  look.backdrop_edge = hex_color(dark ? 0x191c20 : 0xd5d8db);
  look.floor_ambient = dark ? Rgb{0.30f, 0.32f, 0.35f} : Rgb{0.40f, 0.42f, 0.46f};

  look.floor = list.floor;
  look.floor_center = Vec3f(center.x(), list.floor, center.z());
  look.floor_fade = 4.0f * radius;
  look.occlusion_radius = std::min(0.36f * view.half_height, 0.36f * radius);

  look.gloss = {0.15f, 0.02f, 0.05f, 0.10f};
  look.fresnel = {0.30f, 0.07f, 0.20f, 0.22f};

  look.albedo.resize(1024);
  const Coloring& coloring = list.coloring;
  const Rgb crack = to_linear(hex_color(kCrack)), grip = to_linear(hex_color(kGrip));
  for (int i = 0; i < 256; ++i) {
    const float t = static_cast<float>(i) / 255;
    const Rgb field =
        to_linear(coloring.map == ColorMap::pieces ? piece_color(i) : ramp_color(coloring.map, t));
    look.albedo[static_cast<std::size_t>(4 * i)] = field;
    look.albedo[static_cast<std::size_t>(4 * i + 1)] = scaled(crack, 1.28f - 0.30f * t);
    look.albedo[static_cast<std::size_t>(4 * i + 2)] = grip;
    look.albedo[static_cast<std::size_t>(4 * i + 3)] = field;
  }
  return look;
}

}  // namespace rend
