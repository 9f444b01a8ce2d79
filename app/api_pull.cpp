// The pull tool of a viewer.
#include "app/api_pull.h"

#include "app/api_body.h"
#include "engine/material/law_constants.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rend {

namespace {

constexpr Real kRadiusShare = 0.07;  // of the diagonal of all matter
constexpr Real kStrengthFactor = 1.5;
constexpr Real kElasticStrain =
    0.1;  // matter without a threshold is pulled as if it bore this strain
constexpr Real kMostNewton = 1e12;  // of a spring, and on each axis of a constant force
constexpr Real kFarthest = 1e6;     // from the origin [m]
constexpr Real kWidest = 1e3;       // radius of a grip [m]

Real two_digits(Real value) {
  if (!(value > 0)) return value;
  const Real power = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return std::round(value / power) * power;
}

}  // namespace

Grip suitable_grip(const Stage& stage) {
  const SceneDesc& scene = stage.scene;
  Real bears = 0;
  for (const MaterialDesc& m : scene.materials) {
    const Real elastic = kElasticStrain * m.youngs_modulus;
    const bool yields = !yield_surface_parameters(m.yield_surface.type).empty();
    bears =
        std::max(bears, yields ? std::min(elastic, initial_threshold(m.yield_surface)) : elastic);
  }
  Grip grip;
  grip.radius = two_digits(std::max(kRadiusShare * stage.size, 2 * scene.grid.dx));
  grip.strength =
      two_digits(kStrengthFactor * std::numbers::pi * grip.radius * grip.radius * bears);
  return grip;
}

SetPull read_pull(const std::string& text) {
  const JsonValue body = parse_body(text, {"at", "target", "force", "radius", "strength"});
  SetPull set;
  PullForce& pull = set.pull;
  pull.radius = read_number(body, "radius", 0, kWidest);
  if (pull.radius == 0) return set;
  set.keeps_grip = body.find("target") && !body.find("at");
  if (!set.keeps_grip) pull.at = read_vector(body, "at", kFarthest);
  if (!body.find("target")) {
    pull.force = read_vector(body, "force", kMostNewton);
    return set;
  }
  pull.target = read_vector(body, "target", kFarthest);
  pull.strongest = read_number(body, "strength", 0, kMostNewton);
  pull.stiffness = pull.strongest / (2 * pull.radius);
  return set;
}

nlohmann::json pull_json(const PullForce& pull) {
  if (!(pull.radius > 0)) return nullptr;
  const auto list = [](const Vec3& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  return {{"at", list(pull.at)},
          {"target", list(pull.is_spring() ? pull.target : pull.at)},
          {"force", list(pull.force)},
          {"radius", pull.radius}};
}

}  // namespace rend
