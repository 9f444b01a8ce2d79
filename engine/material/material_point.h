// One material point in three dimensions: from a trial deformation gradient to stress, and driven
// along a path.
#pragma once

#include "engine/core/types.h"
#include "engine/material/law_constants.h"

#include <span>
#include <vector>

namespace rend {

/// Principal stretches below this are raised to it on the trial state, and so is a flat or inverted
/// F: Hencky strain has no meaning there, but a finite stress that pushes it open has.
inline constexpr Real kSmallestStretch = 0.05;

/// What one step made of a material point.
struct PointUpdate {
  Mat3 tau;               ///< Kirchhoff stress [Pa]
  Real least_stress = 0;  ///< smallest principal Kirchhoff stress [Pa]
  Real dissipation = 0;   ///< energy per rest volume let go [J/m3]
  bool yielded = false;   ///< in this step, or damaged
  bool damaged = false;
  bool clamped = false;  ///< a stretch was raised to kSmallestStretch
};

/// Maps the trial elastic deformation gradient F to the admissible one, F <- U diag(exp(eps' -
/// eps)) U^T F with F F^T = U diag(exp(2 eps)) U^T, and moves the state tau_c (see
/// material_response) of a particle that started with tau_c0.
using StressUpdate = PointUpdate (*)(const LawConstants<Real>& k, Mat3& F, Real& tau_c,
                                     Real tau_c0);

struct MaterialDesc;

/// The update for the yield surface and damage of a material, chosen once.
StressUpdate stress_update(const MaterialDesc& material);

/// Elastic energy per rest volume [J/m3] of the elastic deformation gradient F.
Real elastic_energy_density(const LawConstants<Real>& k, const Mat3& F, bool damaged);

/// One row of a driven path.
struct ProbeRow {
  Mat3 tau;              ///< Kirchhoff stress [Pa]
  Real tau_c = 0;        ///< threshold [Pa]; 0 once damaged
  bool yielded = false;  ///< in this row
  Real dissipation = 0;  ///< per rest volume since the start [J/m3]
};

/// Drives one material point from rest along the total deformation gradients `path`.
/// @throws Error naming the row when det F <= 0 or F is not finite.
std::vector<ProbeRow> probe(const MaterialDesc& material, std::span<const Mat3> path);

}  // namespace rend
