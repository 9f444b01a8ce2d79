// The controls table.
#include "app/controls.h"

#include "engine/core/error.h"
#include "engine/scene/crack_band.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

/// A slider over five decades at most around the scene's own value, inside what the law allows.
void set_range(Control& control, Real value, Real allowed_min, Real allowed_max) {
  if (value > 0) {
    control.logarithmic = true;
    control.min = std::max(allowed_min, value / 100);
    control.max = std::min(allowed_max, value * 100);
  } else {
    control.min = std::max(allowed_min, Real(0));
    control.max = std::min(allowed_max, Real(1e6));
  }
}

Control fracture_energy(const MaterialDesc& material, std::size_t m, const std::string& id, const std::string& group) {
  Control c{id, "Fracture energy", "J/m2", "What a crack takes per area; softening follows from it.", group};
  set_range(c, *material.fracture_energy, 1e-9, 1e12);
  c.get = [m](const SceneDesc& s) { return *s.materials[m].fracture_energy; };
  c.set = [m](SceneDesc& s, Real value) { s.materials[m].fracture_energy = value; };
  return c;
}

void add_material(std::vector<Control>& controls, const SceneDesc& scene, std::size_t m) {
  const MaterialDesc& material = scene.materials[m];
  const std::string pointer = "/materials/" + material.name;
  const std::string group = scene.materials.size() > 1 ? "Material " + material.name : "Material";
  const auto parameters = yield_surface_parameters(material.yield_surface.type);
  const auto softening = find_parameter(material.yield_surface.type, "softening");
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    if (k == softening && material.fracture_energy) {
      controls.push_back(fracture_energy(material, m, pointer + "/yield_surface/fracture_energy", group));
      continue;
    }
    const Parameter& parameter = parameters[k];
    Control c{pointer + "/yield_surface/" + parameter.name, parameter.label, parameter.unit, parameter.help, group};
    set_range(c, material.yield_surface.value[k], parameter.min, parameter.max);
    c.hero = m == 0 && k == 0;
    c.get = [m, k](const SceneDesc& s) { return s.materials[m].yield_surface.value[k]; };
    c.set = [m, k](SceneDesc& s, Real value) { s.materials[m].yield_surface.value[k] = value; };
    controls.push_back(std::move(c));
  }
  Control stiffness{pointer + "/youngs_modulus", "Stiffness (Young's modulus)", "Pa",
                    "Stiffer matter needs smaller time steps.", group};
  set_range(stiffness, material.youngs_modulus, material.youngs_modulus / 10, material.youngs_modulus * 10);
  stiffness.get = [m](const SceneDesc& s) { return s.materials[m].youngs_modulus; };
  stiffness.set = [m](SceneDesc& s, Real value) { s.materials[m].youngs_modulus = value; };
  controls.push_back(std::move(stiffness));
}

Real stretch_or_default(const SceneDesc& scene) { return scene.fracture.stretch.value_or(2); }

void add_fracture(std::vector<Control>& controls, const SceneDesc& scene) {
  if (scene.fracture.break_test == BreakTest::gap) {
    Control gap{"/fracture/gap", "Crack opening", "spacings", "Smaller shows finer cracks sooner.", "Fracture mesh", 0.1, 2};
    gap.get = [](const SceneDesc& s) { return s.fracture.gap; };
    gap.set = [](SceneDesc& s, Real value) { s.fracture.gap = value; };
    controls.push_back(std::move(gap));
  } else {
    Control stretch{"/fracture/stretch", "Stretch threshold", "x", "Length over rest length.", "Fracture mesh", 1.05, 4};
    stretch.get = stretch_or_default;
    stretch.set = [](SceneDesc& s, Real value) { s.fracture.stretch = value; };
    controls.push_back(std::move(stretch));
  }
  Control smoothing{"/fracture/smoothing_iterations", "Smoothing", "passes", "Smooths crack faces.", "Fracture mesh", 0, 20};
  smoothing.whole = true;
  smoothing.get = [](const SceneDesc& s) { return static_cast<Real>(s.fracture.smoothing_iterations); };
  smoothing.set = [](SceneDesc& s, Real value) { s.fracture.smoothing_iterations = static_cast<int>(value); };
  controls.push_back(std::move(smoothing));
  Control smallest{"/fracture/smallest_fragment", "Smallest fragment", "particles", "Smaller crumbs are not drawn.",
                   "Fracture mesh", 1, 200};
  smallest.whole = true;
  smallest.get = [](const SceneDesc& s) { return static_cast<Real>(s.fracture.smallest_fragment); };
  smallest.set = [](SceneDesc& s, Real value) { s.fracture.smallest_fragment = static_cast<int>(value); };
  controls.push_back(std::move(smallest));
  for (auto c = controls.end() - 3; c != controls.end(); ++c) c->applies = Applies::postprocess;
}

}  // namespace

std::vector<Control> make_controls(const SceneDesc& scene) {
  std::vector<Control> controls;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) add_material(controls, scene, m);
  Control gravity{"/gravity/1", "Gravity along y", "m/s2", "Negative pulls down.", "World", -30, 30};
  gravity.get = [](const SceneDesc& s) { return s.gravity.y(); };
  gravity.set = [](SceneDesc& s, Real value) { s.gravity.y() = value; };
  controls.push_back(std::move(gravity));
  add_fracture(controls, scene);
  return controls;
}

void set_values(SceneDesc& scene, const std::vector<Control>& controls, const ControlValues& values) {
  SceneDesc changed = scene;
  for (const auto& [id, value] : values) {
    const auto control = std::find_if(controls.begin(), controls.end(), [&, &id = id](const Control& c) { return c.id == id; });
    const std::string where = "/values/" + id;
    if (control == controls.end()) throw Error(where, "there is no such control");
    if (!std::isfinite(value) || value < control->min || value > control->max)
      throw Error(where, fmt::format("{} is out of range; {} to {} {} is allowed", value, control->min, control->max,
                                     control->unit));
    if (control->whole && value != std::floor(value)) throw Error(where, fmt::format("{} is not a whole number", value));
    control->set(changed, value);
  }
  for (std::size_t m = 0; m < changed.materials.size(); ++m) {
    const std::string& name = changed.materials[m].name;
    try {
      derive_softening(changed, m, "/materials/" + name);
    } catch (const Error& error) {
      const std::string pointer = "/materials/" + name + "/";
      const auto own = values.lower_bound(pointer);
      const bool asked = own != values.end() && own->first.starts_with(pointer);
      throw Error(asked ? "/values/" + own->first : error.where(),
                  "the fracture energy of \"" + name + "\" " + error.why());
    }
  }
  scene = std::move(changed);
}

}  // namespace rend
