// V10: a copper bar of 3.2 x 32.4 mm hits a rigid wall without friction at 227 m/s (Wilkins and
// Guinan, J. Appl. Phys. 44, 1973, 1200); the scene is scenes/taylor_bar.json.
#include "engine/mesh/build_model.h"
#include "engine/scene/scene_reader.h"
#include "tests/verification/method.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

constexpr Real kRadius = 3.2e-3, kHeight = 32.4e-3;

struct Shape {
  Real length = 0, foot = 0;  // [m]
};

// Radius at the height of some particles: their distance from the axis runs on to the rest radius
// of the bar.
Real radius_of(const Model& model, const Matter& now, Real low, Real high) {
  Real n = 0, sr = 0, sR = 0, srR = 0, sRR = 0;
  for (std::size_t p = 0; p < now.x.size(); ++p) {
    const Real Y = model.X[p][1], R = std::hypot(model.X[p][0], model.X[p][2]);
    if (Y < low || Y > high || R < 0.8 * kRadius) continue;
    const Real r = std::hypot(now.x[p][0], now.x[p][2]);
    n += 1;
    sr += r;
    sR += R;
    srR += r * R;
    sRR += R * R;
  }
  const Real slope = (n * srR - sr * sR) / (n * sRR - sR * sR);
  return sr / n + slope * (kRadius - sR / n);
}

Shape strike(Real dx, SolverDesc solver) {
  SceneDesc scene = read_scene(std::string(REND_SOURCE_DIR) + "/scenes/taylor_bar.json");
  scene.grid.dx = dx;
  scene.solver = solver;
  const Model model = build_model(scene);
  Trial trial(scene, model);
  FrameReport report;
  for (int frame = 0; frame < scene.frames; frame += 10) {
    report = trial->advance(10 / scene.frame_rate);
    REQUIRE(report.status == Status::ok);
  }
  const Matter now = trial.matter();
  const Real spacing = dx / 2;
  Shape out;
  Real top = -1;
  for (std::size_t p = 0; p < now.x.size(); ++p)
    if (model.X[p][1] > kHeight - spacing) top = std::max(top, now.x[p][1]);
  out.length = top + 0.5 * spacing;
  out.foot = radius_of(model, now, 0, 1.01 * spacing);
  MESSAGE(fmt::format(
      "{:26} dx = R/{:.0f}, {} particles, {} steps: length {:.2f} mm, foot radius {:.2f} mm, "
      "kinetic energy left {:.1e}, dissipated {:.4f} of the start",
      method_name(solver), kRadius / dx, now.x.size(), report.substeps * 8, 1e3 * out.length,
      1e3 * out.foot, report.kinetic_energy,
      report.dissipated_energy / (0.5 * report.mass * 227 * 227)));
  return out;
}

}  // namespace

// Kamoulakos (1990) and later codes: 21.4 to 21.5 mm and 7.0 to 7.2 mm.
constexpr Real kFinalLength = 21.45e-3, kFootRadius = 7.1e-3;

TEST_CASE("V10 Taylor bar: final length and foot radius") {
  const SolverDesc apic =
      method(Transfer::apic, Kernel::quadratic, ForceForm::mls, Precision::float32);
  const Shape coarse = strike(kRadius / 4, apic);
  CHECK(coarse.length == doctest::Approx(kFinalLength).epsilon(0.03));
  CHECK(coarse.foot == doctest::Approx(kFootRadius).epsilon(0.08));
  if (!full_study()) return;
  strike(kRadius / 6, apic);
  const Shape fine = strike(kRadius / 8, apic);
  CHECK(fine.length == doctest::Approx(kFinalLength).epsilon(0.015));
  CHECK(fine.foot == doctest::Approx(kFootRadius).epsilon(0.04));
  for (Transfer transfer : {Transfer::pic, Transfer::rpic}) {
    SolverDesc damped = apic;
    damped.transfer = transfer;
    strike(kRadius / 8, damped);
  }
  SolverDesc exact = apic;
  exact.precision = Precision::float64;
  const Shape reference = strike(kRadius / 4, exact);
  CHECK(coarse.length == doctest::Approx(reference.length).epsilon(1e-3));
  CHECK(coarse.foot == doctest::Approx(reference.foot).epsilon(1e-3));
  exact.transfer = Transfer::flip;
  strike(kRadius / 4, exact);
}
