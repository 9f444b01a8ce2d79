// What the fracture mesh costs a frame, stage by stage, against how much is broken and how many
// particles there are.
#pragma once

#include "engine/core/types.h"

#include <cstdio>
#include <span>
#include <vector>

namespace rend {

struct FractureBenchRow {
  Index particles = 0;
  Real broken_share = 0;  ///< of all edges at the end [-]
  Real triangles = 0;     ///< per particle
  Real bytes = 0;         ///< tables and crack per particle
  Real test = 0, cut = 0, smooth = 0, pieces = 0, rotations = 0, positions = 0, indices = 0,
       normals = 0;
  Real total = 0;        ///< mean of the last five frames [us per particle]
  Real median = 0;       ///< of all frames [us per particle]
  Real first_crack = 0;  ///< first frame in which something broke [us per particle]
  Real setup = 0;        ///< tables [us per particle]
};

/// A box of about `particles` random particles that comes apart into wavy Voronoi fragments,
/// unzipped from one end over 50 frames, so that about `broken_share` of its edges break.
FractureBenchRow bench_fracture(Index particles, Real broken_share);

/// All sizes by 2, 5 and 20 % as a table; `csv` (optional) receives the same numbers.
void print_fracture_bench(std::span<const Index> sizes, std::FILE* out, std::FILE* csv = nullptr);

}  // namespace rend
