// The studio: lights, surface colours, backdrop and floor of a picture.
#pragma once

#include "render/renderer.h"
#include "render/view.h"

#include <array>

namespace rend {

using Rgb = std::array<float, 3>;

/// Colours of light and matter are linear; backdrop colours are display values in [0, 1].
struct Look {
  Vec3f key_direction, rim_direction, sky_direction;  ///< unit, towards the light
  Rgb key{}, rim{}, sky{}, bounce{};                  ///< radiance
  Rgb fill{};                                         ///< weak light from the camera
  float key_radius = 0.08f;  ///< half angle of the key light [rad], for soft shadows
  float exposure = 0.9f;
  Rgb backdrop_center{}, backdrop_edge{};
  Rgb floor_ambient{};  ///< share of the light on the floor that is not the key
  bool has_floor = true;
  float floor = 0;                          ///< height [m]
  Vec3f floor_center;                       ///< shadows fade with the distance from here [m]
  float floor_fade = 1;                     ///< distance at which they are gone [m]
  float occlusion_radius = 0.1f;            ///< [m]
  float normal_offset = 0, depth_bias = 0;  ///< shadow map: shift along the normal [m], map depth
  std::array<float, 4> gloss{}, fresnel{};  ///< per Kind
  std::vector<Rgb> albedo;                  ///< 1024, index 4 * value + Kind
};

/// Lights relative to the camera, colours by theme and colour map. Sizes follow `radius`, that of
/// what is drawn [m].
Look make_look(const DrawList& list, const PerspectiveView& view, const Vec3f& center, float radius);

}  // namespace rend
