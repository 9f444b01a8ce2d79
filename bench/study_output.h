// What a study leaves: a table for people, the same for programs, and plots.
#pragma once

#include "bench/log_plot.h"

#include <string>
#include <vector>

namespace rend {

struct StudyOutput {
  std::string table;  ///< Markdown
  std::string csv;
  std::vector<LogPlot> plots;
};

}  // namespace rend
