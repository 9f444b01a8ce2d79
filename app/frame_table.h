// frames.csv: one row a frame, the balance sheet of a run.
#pragma once

#include "app/pipeline.h"

#include <string>

namespace rend {

/// Wall seconds that a frame cost after the simulation.
struct FrameCost {
  double post_seconds = 0;    ///< fracture mesh
  double render_seconds = 0;  ///< picture, 0 when none was asked for
};

/// Header line with the column names; SI units throughout.
std::string frame_table_header();

/// One row, comma separated, numbers round-trip exactly.
std::string frame_table_row(const Frame& frame, const FrameCost& cost);

}  // namespace rend
