// Stability limits of explicit MPM.
#include "engine/mpm/time_step.h"

#include <algorithm>
#include <cmath>

namespace rend {

bool keeps_affine_velocity(const SolverDesc& solver) {
  return solver.transfer == Transfer::apic || solver.transfer == Transfer::rpic ||
         (solver.transfer == Transfer::polypic && solver.polypic_modes >= 4);
}

MotionExtremes& MotionExtremes::operator+=(const MotionExtremes& other) {
  stiffness = std::max(stiffness, other.stiffness);
  speed = std::max(speed, other.speed);
  gradient = std::max(gradient, other.gradient);
  element_rate = std::max(element_rate, other.element_rate);
  collider_speed = std::max(collider_speed, other.collider_speed);
  return *this;
}

Real wave_stiffness(Real mu, Real lambda, Real least_principal_stress) {
  return std::max(3 * lambda + 2 * mu, lambda + 2 * mu + std::max(0.0, -least_principal_stress));
}

Real stable_share(const SolverDesc& solver) {
  const bool affine = keeps_affine_velocity(solver);
  const bool cubic = solver.kernel == Kernel::cubic;
  const Real inverse_inertia = cubic ? 3 : 4;
  const Real S = solver.force_form == ForceForm::mls ? inverse_inertia : (cubic ? 3.137 : 6.0);
  const Real linear_theory = affine ? 2 / std::sqrt(2 * S - inverse_inertia) : std::sqrt(2 / S);
  if (solver.deformation_update == DeformationUpdate::exponential) return linear_theory;
  const Real measured_floor = cubic ? 0.64 : 0.53;
  return std::min(linear_theory, measured_floor);
}

Real choose_time_step(const SolverDesc& solver, Real dx, const MotionExtremes& motion,
                      Real remaining) {
  Real dt = remaining;
  if (solver.time_step > 0) {
    dt = solver.time_step;
  } else {
    const auto limit = [&](Real length_or_strain, Real rate) {
      if (rate > 0) dt = std::min(dt, solver.cfl * length_or_strain / rate);
    };
    limit(stable_share(solver) * dx, std::sqrt(motion.stiffness));
    limit(keeps_affine_velocity(solver) ? 1 : std::sqrt(0.5), motion.element_rate);
    limit(dx, std::max(motion.speed, motion.collider_speed));
    limit(0.5, motion.gradient);
  }
  // The small tolerance keeps a fixed step from gaining a spurious extra step by round-off.
  const Real steps = std::ceil(remaining / dt * (1 - 1e-12));
  return steps > 1 ? remaining / steps : remaining;
}

}  // namespace rend
