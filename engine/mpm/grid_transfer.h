// Moving mass, momentum and force from particles to nodes, and velocity back.
#pragma once

#include "engine/mpm/block_grid.h"
#include "engine/mpm/particles.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// What particle p reads from the grid apart from its own velocity.
struct GridSample {
  Vec3 pic = Vec3::Zero();       ///< sum w v_i, moves the particle [m/s]
  Mat3 gradient = Mat3::Zero();  ///< grad v [1/s]: B D^-1 (mls) or sum v_i (grad w)^T (gradient)
};

/// The two loops for one choice of kernel, transfer scheme and force form, picked once per solver.
struct GridTransfer {
  using ParticleBlock = BlockGrid::ParticleBlock;

  /// First node of the support of x.
  Vec3i (*first_node)(const Vec3& x, Real dx) = nullptr;
  /// m_i += w m_p, p_i += w m_p v_p(x_i), f_i -= V_p tau_p g with g = grad w or w D^-1 (x_i - x_p).
  void (*scatter)(const ParticleBlock&, const Particles&, Real dx, BlockGrid&) = nullptr;
  /// New velocities of the particles of a block, and a sample for each of them in order.
  void (*gather)(const ParticleBlock&, const BlockGrid&, Real dx, const SolverDesc&, Particles&,
                 GridSample*) = nullptr;
  /// momentum_i += w m_p sum_j w_pj velocity_j, over all nodes of the grid.
  void (*project)(const ParticleBlock&, const BlockGrid&, const Particles&, Real dx,
                  const Vec3* velocity, Vec3* momentum) = nullptr;
  Real inertia = 0;      ///< D / dx^2
  CarriedModes carried;  ///< what particles hold beyond their velocity
};

/// @throws Error when the transfer scheme is not covered.
GridTransfer make_grid_transfer(const SolverDesc& solver);

}  // namespace rend
