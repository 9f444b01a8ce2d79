// CPU time of the process, summed up by scope.
#pragma once

#include "engine/core/types.h"

#include <ctime>

namespace rend {

/// CPU seconds of all threads of this process so far.
inline Real cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<Real>(t.tv_sec) + 1e-9 * static_cast<Real>(t.tv_nsec);
}

/// Adds the CPU seconds of its scope to a total.
class Stopwatch {
 public:
  explicit Stopwatch(Real& total) : total_(total), begin_(cpu_seconds()) {}
  ~Stopwatch() { total_ += cpu_seconds() - begin_; }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  Real& total_;
  Real begin_;
};

}  // namespace rend
