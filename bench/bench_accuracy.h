// The work-precision study: error against CPU time of every scheme, kernel, force form and solver.
#pragma once

#include "bench/accuracy_problems.h"
#include "bench/study_output.h"

#include <cstdio>

namespace rend {

/// Runs all problems on one thread (accuracy_problems.h); `scenes` holds taylor_bar.json.
StudyOutput bench_accuracy(StudySize size, const std::filesystem::path& scenes,
                           std::FILE* progress = nullptr);

/// Fronts of every problem, and how much faster the tile solver is at equal error, as Markdown.
std::string accuracy_table(const std::vector<AccuracyRow>& rows);

std::vector<LogPlot> accuracy_plots(const std::vector<AccuracyRow>& rows);

}  // namespace rend
