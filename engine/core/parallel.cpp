// Parallel loops on oneTBB; its workers sleep when idle, so they leave the cores to server and renderer.
#include "engine/core/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include <memory>

#ifdef REND_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace rend {

namespace {

/// Tells ThreadSanitizer the one promise of parallel_for: what the caller did happens before every chunk, and every chunk
/// happens before parallel_for returns. Debian's oneTBB is not instrumented, and neither is this file, so the sanitizer
/// sees nothing of the queues in between. Two chunks stay unordered: a race between them is reported.
class HandOver {
 public:
#ifdef REND_THREAD_SANITIZER
  void give_out() { __tsan_release(&out_); }
  void start_chunk() { __tsan_acquire(&out_); }
  void end_chunk() { __tsan_release(&back_); }
  void take_back() { __tsan_acquire(&back_); }

 private:
  char out_ = 0, back_ = 0;
#else
  void give_out() {}
  void start_chunk() {}
  void end_chunk() {}
  void take_back() {}
#endif
};

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
  HandOver hand_over;
  const auto run = [&](Index chunk) {
    hand_over.start_chunk();
    const Index begin = chunk * grain;
    body(begin, std::min(count, begin + grain));
    hand_over.end_chunk();
  };
  if (chunks == 1) return run(0);
  hand_over.give_out();
  oneapi::tbb::parallel_for(Index(0), chunks, run);
  hand_over.take_back();
}

}  // namespace rend
