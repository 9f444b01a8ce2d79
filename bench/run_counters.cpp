// Linux's performance counters and high-water mark.
#include "bench/run_counters.h"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <limits>
#include <string>

namespace rend {

namespace {

constexpr Real kUnknown = std::numeric_limits<Real>::quiet_NaN();

}  // namespace

RunCounters::RunCounters() {
  std::ofstream("/proc/self/clear_refs") << "5";  // the mark starts again from what is in use
  perf_event_attr what{};
  what.type = PERF_TYPE_HARDWARE;
  what.size = sizeof(what);
  what.config = PERF_COUNT_HW_INSTRUCTIONS;
  what.exclude_kernel = 1;
  counter_ = static_cast<int>(syscall(SYS_perf_event_open, &what, 0, -1, -1, 0));
}

RunCounters::~RunCounters() {
  if (counter_ >= 0) close(counter_);
}

Real RunCounters::instructions() const {
  std::uint64_t count = 0;
  if (counter_ < 0 || read(counter_, &count, sizeof(count)) != sizeof(count)) return kUnknown;
  return static_cast<Real>(count);
}

Real RunCounters::peak_memory() const {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return 1024 * std::stod(line.substr(6));
  return kUnknown;
}

}  // namespace rend
