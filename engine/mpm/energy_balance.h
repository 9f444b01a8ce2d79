// The balance sheet of a run: where its energy came from, where it went, and what is left over.
#pragma once

#include "engine/mpm/snapshot.h"

#include <string>

namespace rend {

/// What grid nodes exchange with the outside in a step [J].
struct NodeWork {
  Real external = 0;  ///< done by colliders and the pull tool
  Real friction = 0;  ///< let go by friction on colliders
  NodeWork& operator+=(const NodeWork& other) {
    external += other.external;
    friction += other.friction;
    return *this;
  }
};

/// Sums since the start of a run [J]. With E = kinetic + affine + elastic + gravity energy + dt/2
/// power, E_start + external work = E + dissipated + friction + transfer loss; the last is the
/// remainder: what transfers damp and integration in time adds or takes. Velocities belong to the
/// middle of the last step; dt/2 times the power of the forces brings them to its end, and makes E
/// what symplectic Euler keeps for a harmonic oscillator and in free fall (exactly, so that no
/// resolved vibration shows as loss or gain). Without affine velocities the stress has no part in
/// the power.
struct EnergyBalance {
  Real start = 0;          ///< E at the start, and what live changes have added to it
  Real start_gravity = 0;  ///< its gravity part
  Real dissipated = 0;
  NodeWork nodes;
  Real last_step = 0;  ///< dt [s]
  Real turnover = 0;   ///< most energy that was there at the end of a frame, or went in or out

  /// Begins the sheet with the energies of `report`.
  void open(const FrameReport& report);
  /// Changes the start so that a live change from `before` to `after` leaves no remainder.
  void rebase(const FrameReport& before, const FrameReport& after);
  /// Counts the velocities of `report` as those of the middle of a step of length dt from now on.
  void change_step(const FrameReport& report, Real dt);
  /// E of `report`, see above.
  Real energy(const FrameReport& report) const;
  /// Fills the columns of the sheet into `report`, whose energies are measured.
  void settle(FrameReport& report);
};

/// Kinetic + affine + elastic + gravity energy [J].
Real mechanical_energy(const FrameReport& report);

/// Transfer loss over turnover [-]; negative when the run has gained energy, 0 when nothing moved.
Real energy_drift(const FrameReport& report);

/// Bounds of energy_drift() beyond which a run warns.
inline constexpr Real kMostEnergyGained = 0.02;
inline constexpr Real kMostEnergyLost = 0.75;

/// One sentence when the drift is out of bounds, with what to do; else empty.
std::string energy_warning(const FrameReport& report);

}  // namespace rend
