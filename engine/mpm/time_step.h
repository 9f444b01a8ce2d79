// The stable time step of both solvers.
#pragma once

#include "engine/core/types.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// What the step must respect, as of now: extremes over all particles and colliders.
struct MotionExtremes {
  Real stiffness = 0;       ///< max over particles of wave_stiffness() / rest density [m2/s2]
  Real speed = 0;           ///< max of |v_p| + sqrt(3) dx |C_p| and of the speed of motion [m/s]
  Real gradient = 0;        ///< max of the Frobenius norm of grad v [1/s]
  Real element_rate = 0;    ///< see MeshForce::Sums::rate [1/s]
  Real collider_speed = 0;  ///< fastest point of a collider that can be met [m/s]

  MotionExtremes& operator+=(const MotionExtremes& other);  ///< the larger of each
};

/// Whether particles carry the gradient of their velocity along.
bool keeps_affine_velocity(const SolverDesc& solver);

/// Stiffness that bounds the step of a lone particle and of a prestressed bulk [Pa]:
/// max(3K, lambda + 2 mu + max(0, -tau_min)) with 3K = 3 lambda + 2 mu.
Real wave_stiffness(Real mu, Real lambda, Real least_principal_stress);

/// Largest stable step of a lone particle, in units of dx sqrt(rho0 / 3K). A lone particle is what
/// fracture makes and it is less stable than the bulk. Linear theory for the exponential update
/// (which keeps the isotropic mode linear at any strain), measured floors at finite strain for the
/// linear update: MLS force and affine velocities 2 / sqrt(dx^2/D) = 1, gradient force and affine
/// velocities 2 / sqrt(2S - dx^2/D), S = dx^2 sum |grad w|^2 / w <= 6 (quadratic) or 3.137 (cubic),
/// PIC and FLIP sqrt(2 / S).
Real stable_share(const SolverDesc& solver);

/// The step [s]: `cfl` of the stable step, of that of mesh elements (1 / rate, over sqrt(2) with
/// the damping of transfers without affine velocities), of a cell crossed by the fastest particle
/// or collider, and a strain of at most cfl / 2; or the fixed step of the scene. Divides what
/// remains of the frame evenly.
Real choose_time_step(const SolverDesc& solver, Real dx, const MotionExtremes& motion,
                      Real remaining);

}  // namespace rend
