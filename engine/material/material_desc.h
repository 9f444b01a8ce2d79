// What a body is made of: density, elasticity, yield surface, damage, strength field.
#pragma once

#include "engine/material/yield_surface.h"

#include <optional>
#include <string>

namespace rend {

enum class DamageType { off, zero, granular };

struct DamageDesc {
  DamageType type = DamageType::off;
  Real threshold = 0.1;        ///< damaged once tau_c <= threshold * tau_c0 [-]
  Real shear_factor = 0.3;     ///< mu of damaged material over mu [-]; lambda stays
  Real friction_angle = 30;    ///< of damaged material [deg]
  bool operator==(const DamageDesc&) const = default;
};

/// Strength varied in space by a seeded field tied to the rest position; off when modulus is 0.
struct StrengthFieldDesc {
  Real modulus = 0;  ///< Weibull modulus m [-], larger is more uniform; 0 is off
  Real length = 0;   ///< correlation length [m]
  bool operator==(const StrengthFieldDesc&) const = default;
};

struct MaterialDesc {
  std::string name;
  Real density = 1000;         ///< [kg/m3]
  Real youngs_modulus = 1e5;   ///< [Pa]
  Real poisson_ratio = 0.3;    ///< [-]
  YieldSurface yield_surface;
  SofteningRule softening_rule = SofteningRule::implicit_rule;
  std::optional<Real> fracture_energy;  ///< [J/m2]; when given, softening was derived from it and dx (crack band)
  DamageDesc damage;
  StrengthFieldDesc strength_field;
  bool operator==(const MaterialDesc&) const = default;
};

}  // namespace rend
