// Runs the rend program.
#include "tests/app/program.h"

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace rend::test {

Outcome run_rend(const std::string& arguments, const std::string& before) {
  return run_command(before + "; REND_ROOT='" REND_SOURCE_DIR "' '" REND_BINARY "' " + arguments);
}

Outcome run_command(const std::string& command) {
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot start " + command);
  Outcome outcome;
  std::array<char, 4096> part{};
  while (const std::size_t got = std::fread(part.data(), 1, part.size(), pipe)) outcome.text.append(part.data(), got);
  const int status = pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "rend-test-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(const std::string& name, const std::string& text) const {
  const std::filesystem::path file = path_ / name;
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::string small_scene(const std::string& extra) {
  return R"({
    "name": "small", "frame_rate": 24, "frames": 30, "gravity": [0, 0, 0], "grid": {"dx": 0.05},
    "materials": {"clay": {"density": 1000, "youngs_modulus": 1e5, "poisson_ratio": 0.3,
      "yield_surface": {"type": "rankine", "tau_c": 8e3, "softening": 1e5}, "damage": {"type": "granular"}}},
    "bodies": [{"shape": {"type": "box", "size": [0.6, 0.15, 0.15]}, "material": "clay"}],
    "colliders": [
      {"shape": {"type": "box", "size": [0.15, 0.25, 0.25]}, "contact": "stick",
       "motion": [{"time": 0, "position": [-0.3, 0, 0]}, {"time": 1, "position": [-0.6, 0, 0]}]},
      {"shape": {"type": "box", "size": [0.15, 0.25, 0.25]}, "contact": "stick",
       "motion": [{"time": 0, "position": [0.3, 0, 0]}, {"time": 1, "position": [0.6, 0, 0]}]}])" +
         extra + "}";
}

}  // namespace rend::test
