// Elastic balls and discs that turn or collide: energy and momentum are known for all time.
#pragma once

#include "bench/problems/lattice_model.h"
#include "bench/problems/trial.h"

namespace rend {

/// E = 1000 Pa, rho = 1 kg/m3, two particles a cell and axis unless told; the step is `courant`
/// dx / c_p. Thin bodies are discs: a single layer of particles in plane strain.
struct RoundBodies {
  SceneDesc scene;
  LatticeModel body;
  bool thin;
  int per_axis;

  RoundBodies(const SolverDesc& solver, Real dx, bool thin, Real courant = 0.3, int per_axis = 2);

  void add(const Vec3& centre, Real radius, const Vec3& velocity);
  Trial trial() const;
};

/// Sums over particles, affine velocities included.
struct MotionBalance {
  Real kinetic = 0;
  Vec3 momentum = Vec3::Zero();
  Real spin = 0;  ///< angular momentum about the z axis through the origin
};
MotionBalance motion_balance(const RoundBodies& bodies, const Trial& trial);

/// What a run ended with, relative to its start.
struct RoundResult {
  Real kinetic = 0;   ///< kinetic energy
  Real energy = 0;    ///< kinetic and elastic energy
  Real most = 0;      ///< largest energy on the way
  Real squeezed = 0;  ///< largest elastic energy on the way
  Real momentum = 0;  ///< change over the momentum of half the matter; 0 for one body
  Real spin = 0;      ///< change of angular momentum
  RunCost cost;
};

/// How a problem is resolved.
struct RoundRun {
  int cells = 8;  ///< in a radius
  bool thin = true;
  Real courant = 0.3;
  int per_axis = 2;
};

/// A body of radius 1 m turns at a rim speed of 0.027 c_p for a share of a revolution.
RoundResult turn(const SolverDesc& solver, Real revolutions, const RoundRun& run = {});

/// Two bodies of radius 0.4 m meet at +-1 m/s (0.027 c_p), 0.75 radii off centre.
RoundResult bounce(const SolverDesc& solver, const RoundRun& run = {});

}  // namespace rend
