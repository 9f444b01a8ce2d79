// One ensemble of the crack study: the same body torn eight times, with one thing left to chance.
#pragma once

#include "bench/problems/torn_bar.h"
#include "engine/core/types.h"

#include <functional>
#include <string>
#include <vector>

namespace rend {

/// Mean and standard deviation (of one run, n - 1) of a sample.
struct Spread {
  Real mean = 0, deviation = 0;
};
Spread spread(const std::vector<Real>& values);

struct CrackRow {
  std::string body;     ///< "bar" or "notched bar"
  std::string law;      ///< "alpha" or "fracture_energy"
  std::string force;    ///< "mesh" or "particle"
  std::string varied;   ///< what differs between the runs: "grid shift", "seed", "grid rotation"
  Real dx = 0;          ///< [m]
  Real modulus = 0;     ///< softening [Pa]
  Index particles = 0;  ///< of the first run
  int runs = 0, failed = 0;
  Spread dissipated;  ///< [J]; of bars [J/m2]
  Spread crack_area;  ///< [m2]; of bars over the section
  Spread pieces;
  Spread peak_force;  ///< [N]; of bars [N/m2]
  Real cpu_seconds = 0;
};

/// Fills the spreads from runs that did not stop.
void fill_spreads(CrackRow& row, const std::vector<Torn>& runs);

/// d ln D / d ln dx by least squares over the ensembles of one study that differ in dx.
Real energy_slope(const std::vector<CrackRow>& rows, const CrackRow& study);

/// Same study at another dx.
bool same_study(const CrackRow& a, const CrackRow& b);

std::string crack_csv(const std::vector<CrackRow>& rows);

}  // namespace rend
