// The tile solver where tiles do worst: sparse, thin and fast matter.
#pragma once

#include "engine/core/types.h"

#include <cstdio>
#include <string>
#include <vector>

namespace rend {

/// CPU time per particle and step of one scene, whole frames, and relative to the dense box.
struct WorstCaseRow {
  std::string scene;
  Index particles = 0;
  Index rebins = 0;
  Real cpu_ns = 0;
  Real particles_ns = 0, grid_ns = 0, islands_ns = 0, legs_ns = 0, rebin_ns = 0;  ///< parts of it
  Real ratio_to_dense = 0;
};

/// One thread, the best instruction set, least of three frames of 40 steps; `quick` takes one.
std::vector<WorstCaseRow> bench_worst_cases(bool quick);

void print_worst_cases(const std::vector<WorstCaseRow>& rows, std::FILE* out);

}  // namespace rend
