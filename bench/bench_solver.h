// Speed and error of the solvers on one problem, side by side.
#pragma once

#include "engine/mpm/tile_kernel.h"
#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

#include <cstdio>
#include <string>
#include <vector>

namespace rend {

/// One solver on one problem; times are per particle and step, whole frames with their re-bins and
/// reports.
struct SolverBenchRow {
  std::string solver;   ///< "textbook", "reference" or "tile"
  std::string simd;     ///< instruction set of the tile solver
  std::string surface;  ///< yield surface
  int threads = 1;
  Index particles = 0;
  Index steps = 0, rebins = 0;
  Real cpu_ns = 0;  ///< CPU time of all threads
  Real wall_ns = 0;
  Real ratio_to_textbook = 0;  ///< CPU time of the textbook solver over this one's
  Real fma_share = 0;      ///< 1500 flop per particle and step over the FMA peak of the same run
  Real speedup = 1;        ///< wall time of one thread over this one's
  Real instructions = -1;  ///< per particle and step, -1: not counted
  /// Stages of the tile solver, CPU time.
  Real particles_ns = 0, elements_ns = 0, grid_ns = 0, rebin_ns = 0, frame_ns = 0;
  Real bytes = 0;        ///< particles and grid, per particle
  Real peak_bytes = -1;  ///< growth of the resident memory of the process, -1: not measured
  Real error_v = 0, error_b = 0, error_tau_c = 0;  ///< after 100 steps, -1: not measured
};

/// Runs textbook, reference and tile solver on boxes of 8 particles per cell that stretch, shear
/// and yield: about 100,000 and 1,000,000 particles, 1 and 2 threads, every instruction set of this
/// CPU; `quick` takes 14,000 particles and one thread. Largest error of v, b^e - I and tau_c
/// relative to their largest value, after 100 steps across re-bins of 14,000 particles, against the
/// reference solver.
std::vector<SolverBenchRow> bench_solver(bool quick, std::FILE* progress = nullptr);

/// One row of the tile solver: least CPU time of three frames of `steps` steps.
SolverBenchRow run_tile(const SceneDesc& scene, const Model& model, const TileKernels* kernels,
                        Index steps);
/// Instructions per particle of one whole step on one thread, -1 where they cannot be counted.
double tile_instructions(const SceneDesc& scene, const Model& model, const TileKernels* kernels);

void print_solver_bench(const std::vector<SolverBenchRow>& rows, std::FILE* out,
                        std::FILE* csv = nullptr);

}  // namespace rend
