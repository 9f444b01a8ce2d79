// What the system counts while a run lasts: instructions and memory.
#pragma once

#include "engine/core/types.h"

namespace rend {

/// Counts from its making on, for the calling thread (instructions) and the process (memory).
class RunCounters {
 public:
  RunCounters();
  ~RunCounters();
  RunCounters(const RunCounters&) = delete;
  RunCounters& operator=(const RunCounters&) = delete;

  /// Instructions of the program; not a number where the system has no counter for it.
  Real instructions() const;
  /// Largest resident memory [bytes]; not a number where the system does not say.
  Real peak_memory() const;

 private:
  int counter_ = -1;
};

}  // namespace rend
