// Layout of a material in a state file.
#include "engine/mpm/material_state.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace rend {

namespace {

// MaterialDesc as numbers; the name stays with the scene.
struct MaterialNumbers {
  Real density, youngs_modulus, poisson_ratio;
  YieldSurface yield_surface;
  SofteningRule softening_rule;
  Real fracture_energy;
  DamageDesc damage;
  StrengthFieldDesc strength_field;
};

}  // namespace

void put_material(StateWriter& out, const MaterialDesc& m) {
  MaterialNumbers numbers;
  // Padding must not carry chance bits into the file.
  std::memset(static_cast<void*>(&numbers), 0, sizeof(numbers));
  numbers.density = m.density;
  numbers.youngs_modulus = m.youngs_modulus;
  numbers.poisson_ratio = m.poisson_ratio;
  numbers.yield_surface.type = m.yield_surface.type;
  numbers.yield_surface.value = m.yield_surface.value;
  numbers.softening_rule = m.softening_rule;
  numbers.fracture_energy = m.fracture_energy.value_or(std::numeric_limits<Real>::quiet_NaN());
  numbers.damage.type = m.damage.type;
  numbers.damage.threshold = m.damage.threshold;
  numbers.damage.shear_factor = m.damage.shear_factor;
  numbers.damage.friction_angle = m.damage.friction_angle;
  numbers.strength_field = m.strength_field;
  out.put(numbers);
}

MaterialDesc get_material(StateReader& in, const MaterialDesc& named) {
  MaterialNumbers numbers;
  in.get(numbers);
  MaterialDesc m = named;
  m.density = numbers.density;
  m.youngs_modulus = numbers.youngs_modulus;
  m.poisson_ratio = numbers.poisson_ratio;
  m.yield_surface = numbers.yield_surface;
  m.softening_rule = numbers.softening_rule;
  m.fracture_energy.reset();
  if (!std::isnan(numbers.fracture_energy)) m.fracture_energy = numbers.fracture_energy;
  m.damage = numbers.damage;
  m.strength_field = numbers.strength_field;
  const auto finite_at_least = [](Real x, Real least) { return std::isfinite(x) && x >= least; };
  const int type = m.yield_surface.type, damage = static_cast<int>(m.damage.type),
            rule = static_cast<int>(m.softening_rule);
  StateReader::require(type >= 0 && type < yield_surface_count() && damage >= 0 && damage <= 2 &&
                           rule >= 0 && rule <= 1 && finite_at_least(m.density, 1e-12) &&
                           finite_at_least(m.youngs_modulus, 0) && std::abs(m.poisson_ratio) < 1 &&
                           m.poisson_ratio < 0.5 &&
                           std::all_of(m.yield_surface.value.begin(), m.yield_surface.value.end(),
                                       [](Real x) { return std::isfinite(x); }),
                       "materials");
  return m;
}

}  // namespace rend
