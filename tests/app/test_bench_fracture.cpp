// The fracture mesh keeps its promises on cost: bytes, and ratios of CPU time within one run.
#include "bench/bench_fracture.h"
#include "engine/core/parallel.h"

#include <doctest/doctest.h>

using namespace rend;

TEST_CASE("cost of the fracture mesh: bytes per particle, no slow first crack, linear in particles") {
  set_thread_count(1);
  const FractureBenchRow small = bench_fracture(4000, .05), large = bench_fracture(60000, .05);
  set_thread_count(0);
  CHECK(large.broken_share == doctest::Approx(.05).epsilon(.2));
  CHECK(large.bytes <= 560);
  CHECK(large.first_crack <= 5 * large.median);
  // Within 1.5 on a quiet machine; one with other work shares its caches.
  CHECK(large.median / small.median <= 2.5);
}
