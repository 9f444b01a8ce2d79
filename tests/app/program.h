// Runs the rend program and collects what it says.
#pragma once

#include <filesystem>
#include <string>

namespace rend::test {

struct Outcome {
  int exit_code = -1;
  std::string text;  ///< standard output and error, as they came
};

/// Runs a command of the shell.
Outcome run_command(const std::string& command);

/// Runs `rend` with shell-quoted arguments, after shell commands such as limits.
Outcome run_rend(const std::string& arguments, const std::string& before = ":");

/// A new empty folder that is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file below the folder and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

/// A scene of a few hundred particles that tears within some frames; `extra` is inserted as top-level JSON members.
std::string small_scene(const std::string& extra = "");

}  // namespace rend::test
