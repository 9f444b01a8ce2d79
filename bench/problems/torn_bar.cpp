// The scenes of bar and rod.
#include "bench/problems/torn_bar.h"

#include "engine/core/random.h"
#include "engine/mesh/build_model.h"
#include "engine/scene/motion.h"
#include "engine/scene/scene_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

// Cells across the bar and in a radius of the rod, the same at every dx, so that only the length of
// a cell changes.
constexpr Real kAcross = 3, kRadius = 3;

constexpr Real kDuration = 8;      // [s]
constexpr Real kBarSpeed = 0.075;  // of each grip [m/s]

std::string text_of(const Vec3& v) { return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]); }

std::string grip_text(const Vec3& size, const Vec3& from, const Vec3& to, const Vec3& turn_from,
                      const Vec3& turn_to) {
  return fmt::format(
      R"({{"shape": {{"type": "box", "size": {}}}, "contact": "stick", "motion": [
          {{"time": 0, "position": {}, "rotation": {}}},
          {{"time": {}, "position": {}, "rotation": {}}}]}})",
      text_of(size), text_of(from), text_of(turn_from), kDuration, text_of(to), text_of(turn_to));
}

std::string scene_text(const BarRun& run, const char* surface, const char* damage,
                       const std::string& shape, const Vec3& position, const Vec3& rotation,
                       const std::string& grips) {
  return fmt::format(
      R"({{"name": "bar", "frame_rate": 10, "frames": {}, "gravity": [0, 0, 0],
          "grid": {{"dx": {}}}, "solver": {{"kernel": "{}"}},
          "materials": {{"m": {{"density": 1, "youngs_modulus": 100, "poisson_ratio": 0.3,
            "yield_surface": {{"type": "{}", "tau_c": {}, {}}},
            "damage": {{"type": "{}", "threshold": 0.02}}}}}},
          "bodies": [{{"shape": {}, "material": "m", "force": "{}", "particles_per_cell": {},
            "position": {}, "rotation": {}}}],
          "colliders": [{}]}})",
      10 * kDuration, run.dx, run.solver.kernel == Kernel::cubic ? "cubic" : "quadratic", surface,
      kBarStrength, run.softening, damage, shape, run.mesh_force ? "mesh" : "particle",
      run.particles_per_cell, text_of(position), text_of(rotation), grips);
}

Model model_of(SceneDesc scene, const BarRun& run) {
  if (run.tets == BarTets::delaunay) scene.bodies[0].force = ForceKind::particle;
  scene.seed = 1 + static_cast<std::uint64_t>(run.shift);
  return build_model(scene);
}

// Strength over that of the middle, `along` from it.
float strength_at(Real along, Real dx) {
  const Real share = along / (3 * dx);
  return static_cast<float>(1 + 0.25 * std::min(share * share, 1.0));
}

Vec3 shift_of(const BarRun& run) {
  Random random(3, static_cast<std::uint64_t>(run.shift));
  return run.dx * Vec3(random.next(), random.next(), random.next());
}

Torn per_area(Torn torn, Real area) {
  torn.dissipated /= area;
  torn.peak_force /= area;
  torn.crack_area /= area;
  return torn;
}

}  // namespace

Torn tear_bar(const BarRun& run) {
  const Vec3 shift = shift_of(run);
  const Real width = kAcross * run.dx;
  const Vec3 about_z(0, 0, run.turn + run.pull_angle);
  const Vec3 axis = rotation_from_degrees(about_z).col(0);
  const Real c = std::cos(run.pull_angle * kPi / 180), s = std::sin(run.pull_angle * kPi / 180);
  const auto corner = [&](Real x, Real y) {
    return fmt::format("[{}, {}]", c * x - s * y, s * x + c * y);
  };
  const std::string shape =
      run.pull_angle == 0
          ? fmt::format(R"({{"type": "box", "size": [8, {0}, {0}]}})", width)
          : fmt::format(R"({{"type": "prism", "outline": [{}, {}, {}, {}], "depth": {}}})",
                        corner(-4, -width / 2), corner(4, -width / 2), corner(4, width / 2),
                        corner(-4, width / 2), width);
  std::string grips;
  for (int side : {-1, 1})
    grips += (side > 0 ? ", " : "") + grip_text(Vec3(2, 4, 4), shift + 4 * side * axis,
                                                shift + (4 + kDuration * kBarSpeed) * side * axis,
                                                about_z, about_z);
  SceneDesc scene =
      parse_scene(scene_text(run, "rankine", "granular", shape, shift, Vec3(0, 0, run.turn), grips),
                  "bar", ".");
  scene.solver = run.solver;
  Model model = model_of(scene, run);
  // Matter moves with the grips from the start, so that no wave runs ahead of them.
  for (std::size_t p = 0; p < model.X.size(); ++p) {
    const Real x = axis.dot(model.X[p] - shift);
    model.strength.push_back(strength_at(x, run.dx));
    model.velocity[p] = kBarSpeed * std::clamp(x / 3, -1.0, 1.0) * axis;
  }
  return per_area(tear(scene, model, run.with_fracture_mesh), width * width);
}

Torn twist_rod(const BarRun& run) {
  const Vec3 shift = shift_of(run);
  const Real radius = kRadius * run.dx, half = 7 * run.dx;
  const Real turned = run.slip / (2 * radius);  // each grip at the end [rad]
  std::string grips;
  for (int side : {-1, 1}) {
    const Vec3 at = shift + Vec3(0, half * side, 0);
    grips += (side > 0 ? ", " : "") + grip_text(Vec3(3, 2, 3) * 4 * run.dx, at, at, Vec3::Zero(),
                                                Vec3(0, turned * side * 180 / kPi, 0));
  }
  SceneDesc scene = parse_scene(
      scene_text(
          run, "von_mises", "zero",
          fmt::format(R"({{"type": "cylinder", "radius": {}, "height": {}}})", radius, 2 * half),
          shift, Vec3::Zero(), grips),
      "rod", ".");
  scene.solver = run.solver;
  Model model = model_of(scene, run);
  const Real rate = turned / kDuration;
  for (std::size_t p = 0; p < model.X.size(); ++p) {
    const Vec3 x = model.X[p] - shift;
    model.strength.push_back(strength_at(x[1], run.dx));
    model.velocity[p] = rate * std::clamp(x[1] / (3 * run.dx), -1.0, 1.0) * Vec3::UnitY().cross(x);
  }
  return per_area(tear(scene, model, run.with_fracture_mesh), kPi * radius * radius);
}

}  // namespace rend
