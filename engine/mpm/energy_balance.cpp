// The remainder of the balance sheet, and what it says about a run.
#include "engine/mpm/energy_balance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

void EnergyBalance::open(const FrameReport& report) {
  start = energy(report);
  start_gravity = report.gravity_energy;
}

void EnergyBalance::rebase(const FrameReport& before, const FrameReport& after) {
  start += energy(after) + after.dissipated_energy - energy(before) - before.dissipated_energy;
  start_gravity += after.gravity_energy - before.gravity_energy;
}

void EnergyBalance::change_step(const FrameReport& report, Real dt) {
  start += 0.5 * (dt - last_step) * report.power;
  last_step = dt;
}

Real EnergyBalance::energy(const FrameReport& report) const {
  return mechanical_energy(report) + 0.5 * last_step * report.power;
}

void EnergyBalance::settle(FrameReport& report) {
  const Real present = report.kinetic_energy + report.affine_energy + report.elastic_energy +
                       std::abs(report.gravity_energy - start_gravity);
  turnover = std::max({turnover, std::abs(nodes.external), dissipated + nodes.friction});
  if (std::isfinite(present)) turnover = std::max(turnover, present);
  report.dissipated_energy = dissipated;
  report.friction_energy = nodes.friction;
  report.external_work = nodes.external;
  report.start_energy = start - start_gravity;
  report.gravity_change = report.gravity_energy - start_gravity;
  report.transfer_loss = start + nodes.external - energy(report) - dissipated - nodes.friction;
  report.energy_turnover = turnover;
}

Real mechanical_energy(const FrameReport& r) {
  return r.kinetic_energy + r.affine_energy + r.elastic_energy + r.gravity_energy;
}

Real energy_drift(const FrameReport& r) {
  return r.energy_turnover > 0 ? r.transfer_loss / r.energy_turnover : 0;
}

std::string energy_warning(const FrameReport& r) {
  const Real drift = energy_drift(r);
  if (drift < -kMostEnergyGained)
    return fmt::format(
        "The run has gained {:.3g} J that nothing put in, {:.0f} % of the energy that passed "
        "through it (bound {:.0f} %); lower cfl or time_step.",
        -r.transfer_loss, -100 * drift, 100 * kMostEnergyGained);
  if (drift > kMostEnergyLost)
    return fmt::format(
        "Transfers have damped {:.3g} J, {:.0f} % of the energy that passed through the run (bound "
        "{:.0f} %); use smaller cells, or apic instead of pic.",
        r.transfer_loss, 100 * drift, 100 * kMostEnergyLost);
  return "";
}

}  // namespace rend
