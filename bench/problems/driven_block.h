// A block of particles that the nodes drive along a deformation path with a closed-form answer:
// material law, deformation update and rounding, without any error of dx.
#pragma once

#include "bench/problems/trial.h"

namespace rend {

enum class DrivenPath {
  uniaxial_strain,  ///< Rankine, F = diag(e^s, 1, 1)
  pure_shear        ///< von Mises, F = diag(e^s, e^-s, 1)
};

/// Driven until half the strength is used up.
struct DrivenResult {
  Real stress = 0;       ///< error over tau_c
  Real dissipation = 0;  ///< error over tau_c^2 / (2 alpha)
  Real excess = 0;       ///< largest y over tau_c
  Real least_work = 0;   ///< smallest dissipation of a step over tau_c^2 / (2 alpha)
  RunCost cost;
};

DrivenResult drive(const SolverDesc& solver, SofteningRule rule, DrivenPath path, Index steps);

}  // namespace rend
