// Progress lines.
#include "app/progress.h"

#include "app/say.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace rend {

std::string duration_text(double seconds) {
  if (seconds < 1) return fmt::format("{:.0f} ms", seconds * 1e3);
  if (seconds < 60) return fmt::format("{:.1f} s", seconds);
  const int whole = static_cast<int>(seconds + 0.5);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

ProgressLine::ProgressLine(std::string what) : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) != 0) {
  // Short work says nothing where lines cannot be taken back.
  if (!terminal_) last_ = start_;
}

ProgressLine::~ProgressLine() {
  if (open_) std::fputs("\n", stderr);
}

void ProgressLine::show(double share, const std::string& detail) {
  const Clock::time_point now = Clock::now();
  const auto pause = terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(5000);
  if (last_ != Clock::time_point{} && now - last_ < pause) return;
  last_ = now;
  const double spent = std::chrono::duration<double>(now - start_).count();
  const std::string left =
      share > 0.01 ? fmt::format(", {} left", duration_text(spent * (1 - share) / share)) : std::string();
  if (terminal_) {
    constexpr int kWidth = 24;
    const int filled = static_cast<int>(std::clamp(share, 0.0, 1.0) * kWidth);
    say("\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} % {}{}", what_, "", filled, "", kWidth - filled,
               100 * share, detail, left);
    std::fflush(stderr);
    open_ = true;
  } else {
    say("{} {:.0f} % {}{}\n", what_, 100 * share, detail, left);
  }
}

void ProgressLine::finish(const std::string& summary) {
  if (terminal_ && open_) std::fputs("\r\033[K", stderr);
  open_ = false;
  say("{} {}\n", what_, summary);
}

}  // namespace rend
