// Parallel loops on oneTBB; its workers sleep when idle, so they leave the cores to server and renderer.
#include "engine/core/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include <memory>

namespace rend {

namespace {

std::unique_ptr<oneapi::tbb::global_control>& limit() {
  static std::unique_ptr<oneapi::tbb::global_control> control;
  return control;
}

}  // namespace

int set_thread_count(int threads) {
  using oneapi::tbb::global_control;
  limit().reset();
  if (threads > 0)
    limit() = std::make_unique<global_control>(global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(threads));
  return thread_count();
}

int thread_count() {
  using oneapi::tbb::global_control;
  return static_cast<int>(global_control::active_value(global_control::max_allowed_parallelism));
}

void parallel_chunks(Index count, Index grain, const std::function<void(Index, Index)>& body) {
  if (count <= 0) return;
  const Index chunks = (count + grain - 1) / grain;
  const auto run = [&](Index chunk) {
    const Index begin = chunk * grain;
    body(begin, std::min(count, begin + grain));
  };
  if (chunks == 1) return run(0);
  oneapi::tbb::parallel_for(Index(0), chunks, run);
}

}  // namespace rend
