// What the simulation hands over once a frame: an immutable copy of what one may look at, and its
// balance sheet.
#pragma once

#include "engine/core/types.h"

#include <cstdint>
#include <string>
#include <vector>

namespace rend {

enum class Status { ok, not_finite, too_fast, left_domain, out_of_memory };
const char* status_name(Status status);

/// Numbers of one frame; the columns of frames.csv, all in SI units.
struct FrameReport {
  Index frame = 0;
  Real time = 0;
  Index substeps = 0;
  Real dt_min = 0, dt_max = 0;
  Real sim_seconds = 0;  ///< wall time
  Index particles = 0;
  Real mass = 0;
  Vec3 momentum = Vec3::Zero();
  Vec3 angular_momentum = Vec3::Zero();  ///< about the world origin, with the APIC part
  Real kinetic_energy = 0, elastic_energy = 0, gravity_energy = 0;
  Real affine_energy = 0;      ///< kinetic energy of the affine velocities, sum of m D |C_p|^2 / 2
  Real dissipated_energy = 0;  ///< plastic work and energy let go by damage, since the start
  Real power = 0;              ///< of internal forces and gravity on the moving matter [W]
  Real friction_energy = 0;    ///< let go by friction on colliders, since the start
  Real external_work = 0;      ///< by colliders and the pull tool, since the start
  Real start_energy = 0;       ///< kinetic and elastic at the start, and what live changes added
  Real gravity_change = 0;     ///< of the gravity energy, since the start
  Real transfer_loss = 0;      ///< remainder of the sheet, see EnergyBalance; negative is a gain
  Real energy_turnover = 0;    ///< what transfer_loss is to be compared with, see EnergyBalance
  Real max_speed = 0;
  Index yielded = 0;  ///< particles that have ever yielded
  Index damaged = 0;
  Index clamped =
      0;  ///< particle steps of this frame with a flat or inverted F, see kSmallestStretch
  std::uint64_t state_hash = 0;
  Status status = Status::ok;
  std::string reason;  ///< one sentence with numbers and what to do; empty when ok
  Index culprit = -1;  ///< particle id behind a bad status
};

/// Particles in the order of their stable ids.
struct Snapshot {
  Index frame = 0;
  Real time = 0;                      ///< [s]
  std::vector<Vec3> x;                ///< #P world positions [m]
  std::vector<Vec3f> v;               ///< #P velocities [m/s]
  std::vector<float> damage;          ///< #P 1 - tau_c / tau_c0, 1 when damaged [-]
  std::vector<float> stress;          ///< #P largest principal Kirchhoff stress [Pa]
  std::vector<std::uint8_t> yielded;  ///< #P 1 when the particle has ever yielded
  FrameReport report;
};

}  // namespace rend
