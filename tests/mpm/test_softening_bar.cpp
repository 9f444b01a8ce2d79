// The energy that a crack takes: tied to the grid by a softening modulus, to the material by a
// fracture energy.
#include "bench/problems/method.h"
#include "bench/problems/torn_body.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

using namespace rend;

namespace {

Real mean_energy(Real dx, const std::string& softening, int shifts) {
  Real sum = 0, squares = 0;
  Torn last;
  BarRun run;
  run.dx = dx;
  run.softening = softening;
  run.solver = method(Transfer::apic);
  for (run.shift = 0; run.shift < shifts; ++run.shift) {
    last = tear_bar(run);
    REQUIRE(last.cost.status == Status::ok);
    sum += last.dissipated;
    squares += last.dissipated * last.dissipated;
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
