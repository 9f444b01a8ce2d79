// The tile solver with features on and off, and from small to large.
#pragma once

#include "bench/bench_solver.h"

#include <cstdio>
#include <string>
#include <vector>

namespace rend {

/// A row of the solver benchmark with what is special about it.
struct SolverVariantRow {
  std::string name;
  SolverBenchRow row;
  Real ratio = 1;  ///< CPU time over that of the first row of its table
};

/// One thread, the best instruction set: what a scene without a feature pays (nothing) and what the
/// feature costs. `quick` takes 14,000 particles, else 97,000.
std::vector<SolverVariantRow> bench_features(bool quick, std::FILE* progress = nullptr);

/// One thread, the best instruction set: 10,000 to 4,000,000 particles (`quick`: to 100,000).
std::vector<SolverVariantRow> bench_sizes(bool quick, std::FILE* progress = nullptr);

void print_variants(const char* title, const std::vector<SolverVariantRow>& rows, std::FILE* out);

}  // namespace rend
