// The only place with threads inside a step: loops over fixed chunks, so that results do not depend on
// the number of threads.
#pragma once

#include "engine/core/types.h"

#include <functional>
#include <vector>

namespace rend {

/// Limits the number of worker threads of all parallel loops; 0 means one per core. Returns the number in use.
int set_thread_count(int threads);
int thread_count();

/// Calls body(begin, end) for consecutive chunks of `grain` indices of [0, count), in any order, on any thread.
void parallel_chunks(Index count, Index grain, const std::function<void(Index begin, Index end)>& body);

/// Calls body(i) for every i in [0, count); a convenience over parallel_chunks.
template <class F>
void parallel_for(Index count, Index grain, F&& body) {
  parallel_chunks(count, grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) body(i);
  });
}

/// Sum of term(i) over [0, count): chunk sums are added in index order, so the bits are the same for any
/// number of threads. T needs operator+=.
template <class T, class F>
T ordered_sum(Index count, Index grain, T zero, F&& term) {
  const Index chunks = count > 0 ? (count + grain - 1) / grain : 0;
  std::vector<T> part(static_cast<std::size_t>(chunks), zero);
  parallel_chunks(count, grain, [&](Index begin, Index end) {
    T sum = zero;
    for (Index i = begin; i < end; ++i) sum += term(i);
    part[static_cast<std::size_t>(begin / grain)] = sum;
  });
  T total = zero;
  for (const T& p : part) total += p;
  return total;
}

}  // namespace rend
