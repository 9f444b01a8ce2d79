// The numbers a law reads every step, worked out once per material in double and broadcast to any
// scalar.
#pragma once

#include "engine/material/yield_surface.h"

namespace rend {

inline constexpr int kMaxSurfaceConstants = 13;

/// Lame parameters of St. Venant-Kirchhoff elasticity in Hencky strain [Pa].
struct Lame {
  Real mu = 0;
  Real lambda = 0;
};
Lame lame_parameters(Real youngs_modulus, Real poisson_ratio);

/// All constants of one material for a scalar S; trivially copyable.
template <class S>
struct LawConstants {
  S mu2;                            ///< 2 mu [Pa]
  S inverse_mu2;                    ///< 1 / (2 mu) [1/Pa]
  S lambda;                         ///< [Pa]
  S surface[kMaxSurfaceConstants];  ///< what the yield surface's prepare() wrote
  S damage_threshold;               ///< damaged once tau_c <= damage_threshold * tau_c0 [-]
  S damage_mu2;                     ///< 2 mu of damaged matter [Pa]
  S damage_friction;                ///< bound of |dev eps| per -tr eps of damaged matter [-]
};

struct MaterialDesc;
LawConstants<Real> law_constants(const MaterialDesc& material);

/// Threshold tau_c0 [Pa] that a particle of this surface starts with; 1 for a surface without one.
Real initial_threshold(const YieldSurface& surface);

/// Whether softening is so steep (local snap-back) that the threshold falls to 0 in the step that
/// yields.
bool snaps_back(const MaterialDesc& material);

}  // namespace rend
