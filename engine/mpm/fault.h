// Numerical trouble of a step, and the sentence that tells of it.
#pragma once

#include "engine/mpm/snapshot.h"

#include <string>

namespace rend {

/// What went wrong with which particle.
struct Fault {
  Status status = Status::ok;
  Index particle = -1;
  Real amount = 0;         ///< speed [m/s] or coordinate [m]
  bool tiny_step = false;  ///< too_fast because the stable step has all but vanished
};

/// One sentence with numbers and what to do, for a fault in step `step` of a frame (1 is the first)
/// after `time` [s]; empty when there is none.
std::string describe(const Fault& fault, Real time, Index step);

}  // namespace rend
