// A fixed number of threads behind a bounded queue that refuses instead of growing.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace rend::web {

class WorkerPool {
 public:
  /// `waiting`: jobs that may wait while all threads are busy.
  WorkerPool(int threads, int waiting);
  ~WorkerPool();  ///< drops waiting jobs, waits for running ones

  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  bool try_submit(std::function<void()> job);  ///< false when the pool is full

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable ready_;
  std::deque<std::function<void()>> jobs_;
  std::size_t running_ = 0, capacity_;
  bool closing_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace rend::web
