// The speed of the renderer; left out of the usual run: test_render -ns -tc="speed of pictures".
#include "bench/bench_render.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <iostream>

TEST_CASE("speed of pictures" * doctest::skip()) {
  const auto timings = rend::bench_render(std::getenv("REND_BENCH_FULL") == nullptr);
  rend::print_render_bench(std::cout, timings);
  for (const rend::RenderTiming& t : timings) CHECK(t.cpu_ms > 0);
}
