// model_table LOADER FOLDER...: reads every mesh file below the folders, repairs it, makes a body
// of about 3000 particles of it and prints a row for each.
#include "engine/core/error.h"
#include "engine/mesh/body.h"
#include "engine/mesh/edge_uses.h"
#include "engine/mesh/mesh_import.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/repair_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>

using namespace rend;
namespace fs = std::filesystem;

namespace {

// Before any repair but the welding of equal positions: every edge has one triangle on each side.
bool is_closed(TriangleSurface s) {
  if (s.triangles.empty()) return false;
  weld(s, 1e-6 * bounds_of(s.positions).size().norm());
  Notes ignored;
  drop_degenerate_and_duplicate(s, ignored);
  bool closed = !s.triangles.empty();
  for_each_edge(edge_uses(s.triangles),
                [&](std::span<const EdgeUse> uses) { closed = closed && uses.size() == 2; });
  return closed;
}

struct Counts {
  int files = 0, read = 0, closed = 0, closed_bodies = 0, open_bodies = 0;
};

std::string joined(const std::vector<std::string>& notes) {
  std::string all;
  for (const std::string& n : notes) all += "; " + n;
  return all;
}

void print_row(const fs::path& file, const MeshLoading& loading, Counts& counts) {
  const auto start = std::chrono::steady_clock::now();
  const char* closed = "-";
  std::string result;
  ++counts.files;
  try {
    TriangleSurface surface = import_mesh(file, loading);
    ++counts.read;
    const bool is = is_closed(surface);
    counts.closed += is;
    closed = is ? "closed" : "open";
    std::vector<std::string> notes;
    const auto solid = make_mesh_solid(repair_surface(std::move(surface), notes), 1);
    const Body body = build_body(*solid, {Sampling::poisson, 3000, 1, 0});
    (is ? counts.closed_bodies : counts.open_bodies) += 1;
    result =
        fmt::format("body of {} particles{}{}", body.X.size(), joined(notes), joined(body.notes));
  } catch (const Error& e) {
    result = "refused: " + std::string(e.why());
  }
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  std::printf("| %s | %s | %.1f s | %s |\n", file.filename().c_str(), closed, time.count(),
              result.c_str());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: model_table LOADER FOLDER...\n"), 2;
  MeshLoading loading;
  loading.loader = argv[1];
  Counts counts;
  std::printf("| file | as it comes | time | result |\n|---|---|---|---|\n");
  for (int i = 2; i < argc; ++i) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(argv[i])) {
      std::string e = entry.path().extension().string();
      for (char& c : e) c = char(std::tolower(c));
      for (const char* allowed : {".obj", ".stl", ".ply", ".off", ".gltf", ".glb"})
        if (e == allowed && entry.is_regular_file()) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const fs::path& f : files) print_row(f, loading, counts);
  }
  std::printf(
      "\n%d files, %d read, %d closed of which %d became bodies, %d open ones became bodies after "
      "repair\n",
      counts.files, counts.read, counts.closed, counts.closed_bodies, counts.open_bodies);
}
