// Instructions of a stretch of code, exactly, where hardware counters may be closed.
#pragma once

#include <functional>

namespace rend {

/// Runs `body` in a copy of this process and steps through what lies between its two calls of
/// mark(), one instruction at a time (about a million a few seconds). -1 where the system refuses.
/// @pre nothing needs another thread meanwhile.
double count_instructions(const std::function<void(const std::function<void()>& mark)>& body);

}  // namespace rend
