// A folder for files that go with their owner.
#include "app/temporary_folder.h"

#include "engine/core/error.h"

#include <cstdlib>
#include <system_error>

namespace rend {

TemporaryFolder::TemporaryFolder(const std::string& stem) {
  std::string pattern = (std::filesystem::temp_directory_path() / (stem + "-XXXXXX")).string();
  if (!mkdtemp(pattern.data())) throw Error(pattern, "cannot make a folder for temporary files");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace rend
