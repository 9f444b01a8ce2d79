// `rend bench`: speed against error, as tables and CSV.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rend {

struct BenchOptions {
  std::string name;           ///< one of bench_names()
  bool quick = false;
  std::filesystem::path csv;     ///< empty: no file
  std::filesystem::path out;     ///< folder for tables and plots of studies; empty: none
  std::filesystem::path scenes;  ///< folder of the scenes that studies use
};

const std::vector<std::string>& bench_names();

/// Runs one benchmark and prints its table. @throws Error when a file cannot be written.
void run_bench(const BenchOptions& options);

}  // namespace rend
