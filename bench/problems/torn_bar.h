// Slender bodies with one weak place, torn there: a bar that grips pull and a rod that they twist.
#pragma once

#include "bench/problems/torn_body.h"

namespace rend {

/// Where the tets of the body come from.
enum class BarTets { stuffed, delaunay };

/// Strength of the weakest place [Pa].
inline constexpr Real kBarStrength = 4;

/// Fracture energy [J/m2] that dx = 0.1 to 0.4 m can resolve: cracks are open when they have moved
/// 0.4 m with mesh forces, 0.15 m with particle forces, where numerical separation ends at about
/// 0.8 tau_c dx.
inline constexpr Real bar_energy(bool mesh) { return mesh ? 0.8 : 0.3; }

/// A bar 8 m long of three by three cells, or a rod of radius 3 cells, weakest in the middle: its
/// strength there is kBarStrength, three cells away and beyond a quarter more. E = 100 Pa, nu =
/// 0.3, 1 kg/m3.
struct BarRun {
  Real dx = 0.4;
  std::string softening = R"("fracture_energy": 0.8)";  ///< key and value of the yield surface
  int shift = 0;        ///< number of the random shift against the grid
  Real pull_angle = 0;  ///< of the bar against grid and tets, about z [deg]
  Real turn = 0;        ///< of bar and tets against the grid, about z [deg]
  bool mesh_force = true;
  BarTets tets = BarTets::stuffed;
  Real particles_per_cell = 2;
  SolverDesc solver;
  bool with_fracture_mesh = false;
  Real slip = 1;  ///< at the rim of a twisted rod at the end [m]
};

/// Pulls at 0.15 m/s until the bar has parted (Rankine: the crack is its section). Results for a
/// cross-section of 1 m2.
Torn tear_bar(const BarRun& run);

/// Twists the rod about y until it has parted (von Mises: the crack is its section, in mode III).
/// Results for a cross-section of 1 m2, without the core that slides too little:
/// (opening of a used-up crack / slip at the rim)^2 / 6 of the energy.
Torn twist_rod(const BarRun& run);

}  // namespace rend
