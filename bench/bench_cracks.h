// The crack-pattern study: what of a crack depends on the grid, the sampling and the mesh.
#pragma once

#include "bench/accuracy_problems.h"
#include "bench/crack_row.h"
#include "bench/study_output.h"

#include <cstdio>

namespace rend {

/// Ensembles of eight (two in the smallest study) torn bars and notched bars over dx, softening law
/// and force, with grid shift, sampling seed or grid rotation left to chance; tile solver.
/// `scenes` holds the notched bar.
StudyOutput bench_cracks(StudySize size, const std::filesystem::path& scenes,
                         std::FILE* progress = nullptr);

}  // namespace rend
