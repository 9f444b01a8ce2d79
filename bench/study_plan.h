// The runs of a study, listed before the first begins, so that a long one can say how far it is.
#pragma once

#include "engine/core/types.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace rend {

/// Runs that make one row each.
template <class Row>
class StudyPlan {
 public:
  /// `seconds` guesses the CPU time; only its share of the whole matters.
  void add(Real seconds, std::function<Row()> run) { runs_.push_back({seconds, std::move(run)}); }

  /// All rows in order; with `progress` a line a row: how many, time left, what came out.
  std::vector<Row> run_all(std::FILE* progress,
                           const std::function<std::string(const Row&)>& text) const {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    Real all = 0, done = 0;
    for (const Run& run : runs_) all += run.seconds;
    std::vector<Row> rows;
    for (const Run& run : runs_) {
      rows.push_back(run.run());
      done += run.seconds;
      if (!progress) continue;
      const Real elapsed = std::chrono::duration<Real>(Clock::now() - start).count();
      const auto left = std::lround(elapsed * (all - done) / done);
      fmt::print(progress, "{:3} of {}, {:2}:{:02} left | {}\n", rows.size(), runs_.size(),
                 left / 60, left % 60, text(rows.back()));
      std::fflush(progress);
    }
    return rows;
  }

 private:
  struct Run {
    Real seconds;
    std::function<Row()> run;
  };
  std::vector<Run> runs_;
};

}  // namespace rend
