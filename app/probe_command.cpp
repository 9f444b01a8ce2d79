// `rend probe`.
#include "app/probe_command.h"

#include "engine/core/error.h"
#include "engine/material/material_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <ostream>
#include <sstream>

namespace rend {

namespace {

constexpr const char* kPathHeader = "F11,F12,F13,F21,F22,F23,F31,F32,F33";

std::string without_spaces(std::string text) {
  std::erase_if(text, [](unsigned char c) { return std::isspace(c); });
  return text;
}

Mat3 parse_row(const std::string& line, const std::string& where) {
  Mat3 F;
  std::stringstream cells(line);
  std::string cell;
  for (int k = 0; k < 9; ++k) {
    std::size_t used = 0;
    try {
      if (!std::getline(cells, cell, ',')) throw std::invalid_argument("too few");
      F(k / 3, k % 3) = std::stod(cell, &used);
    } catch (const std::exception&) {
      used = std::string::npos;
    }
    if (used != cell.size() || !std::isfinite(F(k / 3, k % 3)))
      throw Error(where, fmt::format("needs nine finite numbers ({}), but has \"{}\"", kPathHeader, line.substr(0, 80)));
  }
  if (std::getline(cells, cell)) throw Error(where, "has more than nine numbers");
  return F;
}

std::vector<Mat3> read_path(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw Error(file.string(), "cannot be read");
  std::string line;
  std::getline(in, line);
  if (without_spaces(line) != kPathHeader) throw Error(file.string() + ":1", fmt::format("must be the header {}", kPathHeader));
  std::vector<Mat3> path;
  for (int number = 2; std::getline(in, line); ++number) {
    line = without_spaces(line);
    if (!line.empty()) path.push_back(parse_row(line, fmt::format("{}:{}", file.string(), number)));
  }
  return path;
}

}  // namespace

void probe_material(const SceneDesc& scene, const std::string& material, const std::filesystem::path& path,
                    std::ostream& out) {
  const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                  [&](const MaterialDesc& m) { return m.name == material; });
  if (found == scene.materials.end()) {
    std::string known;
    for (const MaterialDesc& m : scene.materials) known += (known.empty() ? "" : ", ") + m.name;
    throw Error("--material " + material, "the scene has no such material; it has " + known);
  }
  const std::vector<Mat3> F = read_path(path);
  const std::vector<ProbeRow> rows = probe(*found, F);
  out << "step," << kPathHeader << ",tau11,tau12,tau13,tau21,tau22,tau23,tau31,tau32,tau33,tau_c,yielded,dissipation\n";
  for (std::size_t n = 0; n < rows.size(); ++n) {
    out << n + 1;
    for (int k = 0; k < 9; ++k) out << fmt::format(",{}", F[n](k / 3, k % 3));
    for (int k = 0; k < 9; ++k) out << fmt::format(",{}", rows[n].tau(k / 3, k % 3));
    out << fmt::format(",{},{:d},{}\n", rows[n].tau_c, rows[n].yielded, rows[n].dissipation);
  }
}

}  // namespace rend
