// CPU time of a picture, stage by stage, for two sizes of torn torus.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace rend {

/// CPU milliseconds (all threads together) of one stage: the least of several runs.
struct RenderTiming {
  int triangles = 0;
  std::string stage;
  double cpu_ms = 0;
};

/// Live frames of 1280 x 720 with about 50 and 200 thousand triangles, and a 1920 x 1080 still of
/// 64 passes of each; `quick` leaves the stills out.
std::vector<RenderTiming> bench_render(bool quick);

void print_render_bench(std::ostream& out, const std::vector<RenderTiming>& timings);

}  // namespace rend
