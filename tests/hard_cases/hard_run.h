// Runs a hard case on every solver and holds it to the common rule: finite, bounded, or stopped
// with a name and the last good frame.
#pragma once

#include "bench/problems/lattice_model.h"
#include "engine/mpm/tile_solver.h"

#include <memory>
#include <string>
#include <vector>

namespace rend {

/// The reference solver (no kernels) or the tile solver on one instruction set.
struct SolverKind {
  std::string name;
  const TileKernels* kernels = nullptr;
  bool reference() const { return kernels == nullptr; }
};

/// The reference solver and the tile solver on each instruction set of this CPU.
std::vector<SolverKind> all_solvers();

/// The reference solver and the tile solver on the best instruction set.
std::vector<SolverKind> main_solvers();

/// Makes the solver with the precision that it needs.
std::unique_ptr<Solver> make(const SolverKind& kind, SceneDesc scene, const Model& model);

struct Run {
  FrameReport last;
  Index frames = 0, steps = 0, clamped = 0;
  Real most_energy = 0;   ///< largest mechanical energy at the end of a frame [J]
  Real least_drift = 0;   ///< most energy gained, as energy_drift()
  Real seconds = 0;       ///< simulated
  bool finished = false;  ///< all frames, without a bad status
};

/// Advances frame by frame; checks after each that everything is finite, and on a bad status that
/// it has a reason, and that time and state are those of the last good frame.
Run run_frames(Solver& solver, int frames, Real duration);

/// Writes a row of the table in docs/accuracy.md to the file that REND_HARD_TABLE names, if any.
void note(const char* id, const std::string& what, const SolverKind& kind, const Run& run,
          const std::string& more = "");
void note(const char* id, const std::string& what, const std::string& solver,
          const std::string& outcome);

/// A body of `count` particles per axis, two to a cell, jittered; at rest around the origin.
LatticeModel block(const Vec3i& count, const Vec3& velocity = Vec3::Zero());

ColliderDesc plane(const Vec3& normal, const Vec3& at, Contact contact, Real friction = 0);

/// Two boxes of stick contact that hold the ends of [-half, half] along x and move from time 0 on.
std::vector<ColliderDesc> grips(Real half, Real speed, Real duration);

}  // namespace rend
