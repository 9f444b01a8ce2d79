// Progress of long work on standard error: one line that refreshes on a terminal, plain lines otherwise.
#pragma once

#include <chrono>
#include <string>

namespace rend {

/// "1 min 20 s", "350 ms"; rounded for people.
std::string duration_text(double seconds);

class ProgressLine {
 public:
  explicit ProgressLine(std::string what);
  ~ProgressLine();

  /// Share 0..1 of the work and a few words on where it stands; prints at most every 100 ms (terminal) or 5 s.
  void show(double share, const std::string& detail);
  void finish(const std::string& summary);

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_{};
  bool terminal_;
  bool open_ = false;
};

}  // namespace rend
