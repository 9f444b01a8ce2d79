// A folder for files that go with their owner.
#pragma once

#include <filesystem>
#include <string>

namespace rend {

class TemporaryFolder {
 public:
  /// Makes `stem`-XXXXXX among the system's temporary files. @throws Error when that is refused.
  explicit TemporaryFolder(const std::string& stem);
  ~TemporaryFolder();  ///< removes it with all that is in it
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rend
