// The energy that a crack takes: tied to the grid by a softening modulus, to the material by a
// fracture energy.
#include "engine/core/random.h"
#include "engine/mesh/build_model.h"
#include "engine/mpm/reference_solver.h"
#include "engine/scene/scene_reader.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

using namespace rend;

namespace {

// Cells across the bar, the same at every dx, so that only the length of a cell changes.
constexpr Real kAcross = 3;

// A bar 8 m long, shifted against the grid and torn by two grips. `softening` is a key and a value.
std::string bar(Real dx, const std::string& softening, Real shift, Real shift_across) {
  const auto grip = [&](int side) {
    return fmt::format(
        R"({{"shape": {{"type": "box", "size": [2, 4, 4]}}, "contact": "stick", "motion": [
            {{"time": 0, "position": [{}, 0, 0]}}, {{"time": 8, "position": [{}, 0, 0]}}]}})",
        4 * side + shift, 4.6 * side + shift);
  };
  return fmt::format(
      R"({{"name": "bar", "frame_rate": 10, "frames": 80, "gravity": [0, 0, 0],
          "grid": {{"dx": {}}}, "solver": {{"precision": "double", "transfer": "apic"}},
          "materials": {{"m": {{"density": 1, "youngs_modulus": 100, "poisson_ratio": 0.3,
            "yield_surface": {{"type": "rankine", "tau_c": 5, {}}},
            "damage": {{"type": "granular", "threshold": 0.02}}}}}},
          "bodies": [{{"shape": {{"type": "box", "size": [8, {}, {}]}}, "material": "m",
            "force": "mesh", "particles_per_cell": 2,
            "position": [{}, {}, {}]}}],
          "colliders": [{}, {}]}})",
      dx, softening, kAcross * dx, kAcross * dx, shift, shift_across, -shift_across, grip(-1),
      grip(1));
}

struct Torn {
  Real energy = 0;  // dissipated, per cross-section [J/m2]
  Real modulus = 0;
  Index damaged = 0;
};

Torn tear(Real dx, const std::string& softening, int shift) {
  Random random(3, static_cast<std::uint64_t>(shift));
  const Real along = dx * random.next(), across = dx * random.next();
  const SceneDesc scene = parse_scene(bar(dx, softening, along, across), "bar", ".");
  Model model = build_model(scene);
  // The crack starts in the middle, in a zone of the same number of cells at every dx.
  model.strength.assign(model.X.size(), 1);
  for (std::size_t p = 0; p < model.X.size(); ++p)
    if (std::abs(model.X[p][0] - along) < dx) model.strength[p] = 0.8f;
  ReferenceSolver solver(scene, model);
  FrameReport report;
  for (int frame = 0; frame < scene.frames; ++frame) {
    report = solver.advance(1 / scene.frame_rate);
    REQUIRE(report.status == Status::ok);
  }
  const auto at = find_parameter(scene.materials[0].yield_surface.type, "softening");
  return {report.dissipated_energy / std::pow(kAcross * dx, 2),
          scene.materials[0].yield_surface.value[*at], report.damaged};
}

Real mean_energy(Real dx, const std::string& softening, int shifts) {
  Real sum = 0, squares = 0;
  Torn last;
  for (int s = 0; s < shifts; ++s) {
    last = tear(dx, softening, s);
    sum += last.energy;
    squares += last.energy * last.energy;
    CHECK(last.damaged > 0);
  }
  const Real mean = sum / shifts;
  MESSAGE(fmt::format("dx {:.3f} {} (modulus {:.1f} Pa): {:.3f} J/m2, s.d. {:.3f}, {} damaged", dx,
                      softening, last.modulus, mean,
                      std::sqrt(std::max(squares / shifts - mean * mean, 0.0)), last.damaged));
  return mean;
}

}  // namespace

TEST_CASE("a crack takes its fracture energy at any dx, and ever less with a softening modulus") {
  const bool full = std::getenv("REND_FULL") != nullptr;
  const int shifts = full ? 8 : 1;
  const Real coarse = 0.4, fine = full ? 0.1 : 0.2;
  const std::string energy = "\"fracture_energy\": 0.5", modulus = "\"softening\": 16";
  const Real energy_change =
      mean_energy(fine, energy, shifts) / mean_energy(coarse, energy, shifts);
  const Real modulus_change =
      mean_energy(fine, modulus, shifts) / mean_energy(coarse, modulus, shifts);
  MESSAGE(fmt::format("change: {:.2f} with fracture_energy, {:.2f} with softening", energy_change,
                      modulus_change));
  CHECK(std::abs(energy_change - 1) < 0.3);
  CHECK(modulus_change < (full ? 1 / 2.5 : 1 / 1.6));
}
