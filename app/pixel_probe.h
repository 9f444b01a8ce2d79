// What lies under a point of the picture, and how the matter there is doing.
#pragma once

#include "app/view.h"

#include <optional>

namespace rend {

/// The matter that a viewer sees at a point of the picture.
struct ProbedMatter {
  Vec3 position = Vec3::Zero();  ///< on the surface [m]
  Vec3 rest = Vec3::Zero();      ///< where it was at time 0 [m]
  Index particle = -1;           ///< id of the particle that was nearest at rest
  Index piece = -1;              ///< fragment; -1 among particles
  bool crack = false;            ///< on a crack face
  std::string material;
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  Real damage = 0;               ///< [-]
  Real threshold = 0;            ///< present yield threshold [Pa]; 0 when damaged or without one
  Real stress = 0;               ///< largest principal Kirchhoff stress [Pa]
  Real nearness = 0;             ///< share of the break threshold used up [-]
  bool yielded = false;
};

/// The first matter on the ray through (x, y), shares of the picture from its top left; nothing
/// where the ray meets a collider first, or nothing. Linear in triangles and particles.
std::optional<ProbedMatter> probe_pixel(const Stage& stage, const Model& model, const Frame& frame,
                                        const View& view, Real x, Real y);

}  // namespace rend
