// Fields of a material: elasticity, yield surface with the parameters of its own list, damage,
// strength field.
#include <cmath>

#include "engine/scene/scene_fields.h"

namespace rend {

namespace {

constexpr const char* kSofteningRules[] = {"implicit", "explicit"};
constexpr const char* kDamageTypes[] = {"off", "zero", "granular"};

std::vector<const char*> yield_surface_names() {
  std::vector<const char*> names;
  for (int type = 0; type < yield_surface_count(); ++type)
    names.push_back(yield_surface_name(type).data());
  return names;
}

void describe_yield_parameters(FieldVisitor& v, MaterialDesc& m, int type) {
  const auto parameters = yield_surface_parameters(type);
  const auto softening = find_parameter(type, "softening");
  const bool can_soften = softening && find_parameter(type, "tau_c");
  if (v.fills()) m.yield_surface.value.fill(0);
  if (can_soften)
    v.optional_number(
        {"fracture_energy", "energy per crack area; sets softening from dx instead of giving it"},
        m.fracture_energy, {"J/m2", 1e-9, 1e12});
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (can_soften && i == *softening && m.fracture_energy) continue;
    const Parameter& p = parameters[i];
    Real& value = m.yield_surface.value[i];
    if (v.fills()) value = p.fallback;
    v.number({p.name, p.help, std::isnan(p.fallback)}, value, {p.unit, p.min, p.max});
  }
  if (can_soften) v.exclusive("fracture_energy", "softening");
  if (!softening) return;
  choose(v,
         {"softening_rule",
          "implicit: the softened threshold holds after the return; explicit: "
          "return first, shrink afterwards"},
         m.softening_rule, kSofteningRules);
}

void describe_yield_surface(FieldVisitor& v, MaterialDesc& m) {
  const std::vector<const char*> names = yield_surface_names();
  v.variant({"type", "which yield surface", true}, m.yield_surface.type, names,
            [&](FieldVisitor& o, int type) { describe_yield_parameters(o, m, type); });
}

void describe_damage(FieldVisitor& v, DamageDesc& d) {
  choose(v,
         {"type",
          "failed material: off keeps it, zero drops all stress, granular keeps contact and "
          "friction"},
         d.type, kDamageTypes);
  v.number({"threshold", "failed once tau_c falls to this share of its first value"}, d.threshold,
           {"-", 0, 1});
  v.number({"shear_factor", "shear modulus of failed material over the first one"}, d.shear_factor,
           {"-", 0, 1});
  v.number({"friction_angle", "of failed material"}, d.friction_angle, {"deg", 0, 89});
}

void describe_strength_field(FieldVisitor& v, StrengthFieldDesc& f) {
  v.number({"modulus", "Weibull modulus, larger is more uniform; 0 switches the field off"},
           f.modulus, {"-", 0, 10000});
  v.number({"length", "correlation length"}, f.length, {"m", 0, 1e4});
}

}  // namespace

void describe_material(FieldVisitor& v, MaterialDesc& m) {
  v.number({"density", "mass per rest volume", true}, m.density, {"kg/m3", 1e-6, 1e6});
  v.number({"youngs_modulus", "stiffness", true}, m.youngs_modulus, {"Pa", 1e-6, 1e13});
  v.number({"poisson_ratio", "0.5 would be incompressible", true}, m.poisson_ratio,
           {"-", 0, 0.4999});
  v.object({"yield_surface", "where it stops being elastic; elastic when left out"},
           [&](FieldVisitor& o) { describe_yield_surface(o, m); });
  v.object({"damage", "what becomes of material that has softened"},
           [&](FieldVisitor& o) { describe_damage(o, m.damage); });
  v.object({"strength_field", "tau_c varied in space by a seeded field"},
           [&](FieldVisitor& o) { describe_strength_field(o, m.strength_field); });
}

}  // namespace rend
