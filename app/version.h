// What `rend --version` prints.
#pragma once

#include <string>

namespace rend {

std::string version_text();

}  // namespace rend
