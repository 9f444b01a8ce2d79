// V10: a copper bar of 3.2 x 32.4 mm hits a rigid wall without friction at 227 m/s (Wilkins and
// Guinan, J. Appl. Phys. 44, 1973, 1200); the scene is scenes/taylor_bar.json.
#include "bench/problems/taylor_bar.h"
#include "tests/verification/method.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

TaylorShape strike(Real dx, const SolverDesc& solver) {
  const TaylorShape out = strike_wall(std::string(REND_SOURCE_DIR) + "/scenes", dx, solver);
  REQUIRE(out.cost.status == Status::ok);
  MESSAGE(fmt::format(
      "{:26} dx = R/{:.0f}, {} particles, {} steps: length {:.2f} mm, foot radius {:.2f} mm, "
      "kinetic energy left {:.1e}, dissipated {:.4f} of the start",
      method_name(solver), kTaylorRadius / dx, out.cost.particles, out.cost.steps, 1e3 * out.length,
      1e3 * out.foot, out.kinetic, out.dissipated));
  return out;
}

}  // namespace

TEST_CASE("V10 Taylor bar: final length and foot radius") {
  const SolverDesc apic =
      method(Transfer::apic, Kernel::quadratic, ForceForm::mls, Precision::float32);
  const TaylorShape coarse = strike(kTaylorRadius / 4, apic);
  CHECK(coarse.length == doctest::Approx(kTaylorLength).epsilon(0.03));
  CHECK(coarse.foot == doctest::Approx(kTaylorFoot).epsilon(0.08));
  if (!full_study()) return;
  strike(kTaylorRadius / 6, apic);
  const TaylorShape fine = strike(kTaylorRadius / 8, apic);
  CHECK(fine.length == doctest::Approx(kTaylorLength).epsilon(0.015));
  CHECK(fine.foot == doctest::Approx(kTaylorFoot).epsilon(0.04));
  for (Transfer transfer : {Transfer::pic, Transfer::rpic}) {
    SolverDesc damped = apic;
    damped.transfer = transfer;
    strike(kTaylorRadius / 8, damped);
  }
  SolverDesc exact = apic;
  exact.precision = Precision::float64;
  const TaylorShape reference = strike(kTaylorRadius / 4, exact);
  CHECK(coarse.length == doctest::Approx(reference.length).epsilon(1e-3));
  CHECK(coarse.foot == doctest::Approx(reference.foot).epsilon(1e-3));
  exact.transfer = Transfer::flip;
  strike(kTaylorRadius / 4, exact);
}
