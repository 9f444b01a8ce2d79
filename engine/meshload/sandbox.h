// Takes every right away from the mesh loader process that reading a mesh does not need.
#pragma once

#include <cstddef>

namespace rend {

/// Limits of this process.
struct SandboxLimits {
  std::size_t memory_bytes;
  unsigned cpu_seconds;
};

/// Sets resource limits and no_new_privs. @return false when the system refuses.
bool limit_resources(const SandboxLimits& limits);

/// From here on memory, write and exit are all this process can ask the system for; opening files
/// fails with EPERM. @return false when the system refuses.
bool enter_sandbox();

}  // namespace rend
