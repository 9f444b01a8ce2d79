// Band widths, and what they make of a fracture energy.
#include "engine/scene/crack_band.h"

#include "engine/core/error.h"
#include "engine/material/law_constants.h"
#include "engine/scene/json_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

/// The softening from which the yield surface of `m` snaps back; asked of the law itself, by
/// halving.
Real snap_back_limit(MaterialDesc m, std::size_t softening) {
  m.softening_rule = SofteningRule::implicit_rule;
  Real& value = m.yield_surface.value[softening];
  Real low = 0, high = value;
  for (int i = 0; i < 60; ++i) {
    value = (low + high) / 2;
    (snaps_back(m) ? high : low) = value;
  }
  return high;
}

/// Largest share in (0, 1) of which `holds` is true; it holds near 0.
template <class F>
Real crossing(F&& holds) {
  Real low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const Real middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

/// How the bodies of a material take their stress.
ForceKind force_of(const SceneDesc& scene, std::size_t material, const std::string& key) {
  const BodyDesc* first = nullptr;
  for (const BodyDesc& body : scene.bodies) {
    if (body.material != material) continue;
    if (first && first->force != body.force)
      throw Error(key,
                  "is shared by bodies with particle and with mesh forces, whose cracks have bands "
                  "of different width; give each of them its own material");
    first = &body;
  }
  return first ? first->force : BodyDesc{}.force;
}

}  // namespace

Real crack_band_width(Kernel kernel, ForceKind force, Real dx, Real opening) {
  const bool cubic = kernel == Kernel::cubic;
  if (force == ForceKind::mesh) return (cubic ? 2.8 : 2.5) * dx;
  return std::min(cubic ? 3.3 : 2.3, (cubic ? 1.7 : 1.1) * std::sqrt(dx / opening)) * dx;
}

void derive_softening(SceneDesc& scene, std::size_t index, const std::string& where) {
  MaterialDesc& m = scene.materials[index];
  if (!m.fracture_energy) return;
  const std::string key = join_pointer(where, "yield_surface") + "/fracture_energy";
  const ForceKind force = force_of(scene, index, key);
  const std::size_t softening = *find_parameter(m.yield_surface.type, "softening");
  const Real tau_c = m.yield_surface.value[*find_parameter(m.yield_surface.type, "tau_c")];
  const auto modulus = [&](Real dx, Real energy) {
    if (!(tau_c > 0)) return Real(0);
    const Real width = crack_band_width(scene.solver.kernel, force, dx, 2 * energy / tau_c);
    return width * tau_c * tau_c / (2 * energy);
  };
  const Real dx = scene.grid.dx, energy = *m.fracture_energy, alpha = modulus(dx, energy);
  m.yield_surface.value[softening] = alpha;
  MaterialDesc implicit = m;
  implicit.softening_rule = SofteningRule::implicit_rule;
  if (!snaps_back(implicit)) return;
  const Real limit = snap_back_limit(m, softening);
  throw Error(
      key, fmt::format(
               "is {} J/m2, which at dx = {} m asks for softening {:.4g} Pa; from {:.4g} Pa "
               "the stress snaps back: take dx below {:.4g} m or fracture_energy above {:.4g} J/m2",
               energy, dx, alpha, limit,
               dx * crossing([&](Real share) { return modulus(share * dx, energy) < limit; }),
               energy / crossing([&](Real share) { return modulus(dx, energy / share) < limit; })));
}

}  // namespace rend
