// VTK XML files of points and triangles (.vtp) and of their time series (.pvd), for ParaView.
#pragma once

#include "app/frame_arrays.h"

#include <string>
#include <vector>

namespace rend {

/// PolyData with raw appended arrays, little-endian, single precision; `time` [s] as TimeValue.
std::string vtp(const FrameArrays& frame, Real time);

/// A file of a time series, named from the folder of the .pvd.
struct SeriesEntry {
  Real time = 0;  ///< [s]
  std::string file;
};

/// A collection that ParaView opens as an animation.
std::string pvd(const std::vector<SeriesEntry>& entries);

}  // namespace rend
