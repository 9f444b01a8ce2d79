// How much work a long study or storm of the tests does.
#pragma once

#include <cstdlib>

namespace rend::test {

/// `full` with REND_FULL=1; `brief` under a sanitizer, where more steps of the same code show nothing new; else `plain`.
template <class T>
T by_effort(T brief, T plain, T full) {
  if (std::getenv("REND_FULL")) return full;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return static_cast<void>(plain), brief;
#else
  return static_cast<void>(brief), plain;
#endif
}

/// The long versions of studies are asked for.
inline bool full_effort() { return by_effort(false, false, true); }

}  // namespace rend::test
