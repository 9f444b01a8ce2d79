// Constants of a material, worked out in double.
#include "engine/material/law_constants.h"

#include "engine/material/yield_surface_list-inl.h"
#include "engine/material/material_desc.h"

#include <cmath>
#include <numbers>

namespace rend {

namespace {

bool prepare_surface(const MaterialDesc& material, Real* constants) {
  const Lame lame = lame_parameters(material.youngs_modulus, material.poisson_ratio);
  bool snap = false;
  with_yield_surface(material.yield_surface.type, [&](auto law) {
    snap =
        law.prepare(lame, material.yield_surface.value.data(), material.softening_rule, constants);
  });
  return snap;
}

}  // namespace

Lame lame_parameters(Real youngs_modulus, Real poisson_ratio) {
  return {youngs_modulus / (2 * (1 + poisson_ratio)),
          youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio))};
}

LawConstants<Real> law_constants(const MaterialDesc& material) {
  const Lame lame = lame_parameters(material.youngs_modulus, material.poisson_ratio);
  LawConstants<Real> k{};
  k.mu2 = 2 * lame.mu;
  k.inverse_mu2 = 1 / k.mu2;
  k.lambda = lame.lambda;
  prepare_surface(material, k.surface);
  k.damage_threshold = material.damage.threshold;
  k.damage_mu2 = material.damage.shear_factor * k.mu2;
  // Cone through the triaxial compression corner of Mohr-Coulomb: |s| = sqrt(2/3) 6 sin(phi)/(3 -
  // sin(phi)) p with pressure p = -(2 mu'/3 + lambda) tr eps and |s| = 2 mu' |dev eps|.
  const Real sine = std::sin(material.damage.friction_angle * std::numbers::pi / 180);
  const Real cone = std::sqrt(2.0 / 3) * 6 * sine / (3 - sine);
  k.damage_friction =
      k.damage_mu2 > 0 ? cone * (k.damage_mu2 / 3 + k.lambda) / k.damage_mu2 : Real(0);
  return k;
}

Real initial_threshold(const YieldSurface& surface) {
  Real threshold = 1;
  with_yield_surface(surface.type, [&](auto law) {
    if constexpr (law.kThreshold >= 0) threshold = surface.value[law.kThreshold];
  });
  return threshold;
}

bool snaps_back(const MaterialDesc& material) {
  Real constants[kMaxSurfaceConstants];
  return prepare_surface(material, constants);
}

}  // namespace rend
