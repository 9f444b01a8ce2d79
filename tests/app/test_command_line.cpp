// The program as people call it: help, runs, and one clear message for each kind of bad input.
#include "tests/app/program.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <vector>

using namespace rend::test;

namespace {

std::string read(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("help reads well for the program and each subcommand") {
  for (const char* command : {"", "serve ", "run ", "check ", "probe "}) {
    CAPTURE(command);
    const Outcome help = run_rend(std::string(command) + "--help");
    CHECK(help.exit_code == 0);
    CHECK(help.text.find("Usage: rend") != std::string::npos);
  }
  CHECK(run_rend("--version").text.find("GPL") != std::string::npos);
}

TEST_CASE("an unknown command or option is bad input") {
  for (const char* arguments : {"", "tear", "run", "run x.json", "serve --port 99999", "run x.json --out o --frames 0"}) {
    CAPTURE(arguments);
    CHECK(run_rend(arguments).exit_code == 2);
  }
}

TEST_CASE("a run leaves pictures, meshes, particles and the table behind") {
  const TemporaryFolder folder;
  const auto scene = folder.write("small.json", small_scene());
  const auto out = folder.path() / "out";
  const Outcome run = run_rend("run '" + scene.string() + "' --frames 3 --size 320x180 --passes 1 --out '" + out.string() + "'");
  CAPTURE(run.text);
  REQUIRE(run.exit_code == 0);
  for (const char* name : {"scene.json", "png/000001.png", "png/000003.png", "mesh/000003.ply", "particles/000002.ply"})
    CHECK(std::filesystem::file_size(out / name) > 100);
  const std::string table = read(out / "frames.csv");
  CHECK(lines_of(table) == 4);
  const std::string header = table.substr(0, table.find('\n'));
  for (const char* column :
       {"frame", "time", "substeps", "dt_min", "dt_max", "sim_seconds", "post_seconds", "render_seconds", "particles", "mass",
        "momentum_x", "momentum_y", "momentum_z", "angular_momentum_x", "angular_momentum_y", "angular_momentum_z",
        "kinetic_energy", "elastic_energy", "gravity_energy", "dissipated_energy", "external_work", "max_speed", "yielded",
        "damaged", "broken_edges", "pieces", "surface_vertices", "surface_triangles", "surface_volume", "state_hash"}) {
    CAPTURE(column);
    CHECK(("," + header + ",").find("," + std::string(column) + ",") != std::string::npos);
  }
  CHECK(run_rend("check '" + (out / "scene.json").string() + "'").exit_code == 0);
}

TEST_CASE("bad scene files: one clear message, exit code 2, nothing written") {
  struct Row {
    const char* what;
    std::string text;
    const char* said;
  };
  const auto replaced = [](const char* from, const char* to) {
    std::string text = small_scene();
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, std::string(from).size(), to);
  };
  const std::vector<Row> rows = {
      {"unknown key", small_scene(R"(, "gravty": [0,0,0])"), "gravity"},
      {"wrong type", replaced("\"frames\": 30", "\"frames\": \"many\""), "/frames"},
      {"NaN", replaced("8e3", "NaN"), "small.json"},
      {"infinite", replaced("8e3", "1e999"), "small.json"},
      {"duplicate key", replaced("\"frames\": 30", "\"frames\": 30, \"frames\": 31"), "frames"},
      {"out of range", replaced("\"poisson_ratio\": 0.3", "\"poisson_ratio\": 0.7"), "/materials/clay/poisson_ratio"},
      {"missing mesh", replaced(R"({"type": "box", "size": [0.6, 0.15, 0.15]})", R"({"type": "mesh", "file": "none.obj", "height": 1})"),
       "none.obj"},
      {"depth 100,000", std::string(100000, '['), "small.json"},
      {"1e9 particles", replaced("\"dx\": 0.05", "\"dx\": 0.0005"), "particles"},
      {"empty", "", "small.json"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.what);
    const TemporaryFolder folder;
    const auto scene = folder.write("small.json", row.text);
    const auto out = folder.path() / "out";
    const Outcome run = run_rend("run '" + scene.string() + "' --frames 1 --out '" + out.string() + "'");
    CAPTURE(run.text);
    CHECK(run.exit_code == 2);
    CHECK(lines_of(run.text) == 1);
    CHECK(run.text.find(row.said) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(out));
  }
}

TEST_CASE("a folder that cannot be written is told before anything is prepared") {
  const TemporaryFolder folder;
  const auto scene = folder.write("small.json", small_scene());
  const auto file = folder.write("file", "not a folder");
  for (const std::string& out : {file.string(), (file / "below").string()}) {
    CAPTURE(out);
    const Outcome run = run_rend("run '" + scene.string() + "' --frames 1 --out '" + out + "'");
    CAPTURE(run.text);
    CHECK(run.exit_code == 2);
    CHECK(lines_of(run.text) == 1);
    CHECK(run.text.find(out) != std::string::npos);
  }
  CHECK(read(file) == "not a folder");
}

TEST_CASE("a disk that takes no more ends the run with the file's name, and leaves whole frames only") {
  const TemporaryFolder folder;
  const auto scene = folder.write("small.json", small_scene());
  const auto out = folder.path() / "out";
  // No file may grow above 32 KiB: the table and the scene fit, a mesh does not.
  const Outcome run = run_rend("run '" + scene.string() + "' --no-png --frames 3 --out '" + out.string() + "'",
                               "trap '' XFSZ; ulimit -f 64");
  CAPTURE(run.text);
  CHECK(run.exit_code == 2);
  CHECK(run.text.find("mesh/000001.ply: cannot write the file") != std::string::npos);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
    CAPTURE(entry.path().string());
    CHECK(entry.path().extension() != ".tmp");
    CHECK(entry.path().filename() != "000001.ply");
  }
}

TEST_CASE("a run takes the place of an earlier one, and one that is refused leaves it alone") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("small.json", small_scene()).string();
  const auto run = [&](const std::string& more) {
    return run_rend("run '" + scene + "' --no-png --out '" + (folder.path() / "out").string() + "' " + more);
  };
  const auto count = [&](const char* name) {
    std::error_code none;
    const std::filesystem::directory_iterator files(folder.path() / "out" / name, none);
    return std::distance(begin(files), end(files));
  };
  REQUIRE(run("--frames 4 --checkpoint-every 2 --formats ply,vtp").exit_code == 0);
  CHECK(run("--set /grid/dx=1000").exit_code == 2);
  CHECK(count("checkpoint") == 2);
  CHECK(count("record") == 4);
  REQUIRE(run("--frames 2").exit_code == 0);
  CHECK(count("checkpoint") == 0);
  CHECK(count("record") == 2);
  CHECK(count("mesh") == 2);
  CHECK(count("particles") == 2);
  CHECK_FALSE(std::filesystem::exists(folder.path() / "out" / "mesh.pvd"));
}

TEST_CASE("remesh refuses frames that are not there and the run itself, before it writes") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("small.json", small_scene()).string();
  const std::string out = (folder.path() / "out").string(), other = (folder.path() / "other").string();
  REQUIRE(run_rend("run '" + scene + "' --no-png --frames 3 --out '" + out + "'").exit_code == 0);
  const auto remesh = [&](const std::string& more) { return run_rend("remesh '" + out + "' --no-png " + more); };
  const auto refused = [&](const std::string& more, const char* why) {
    const Outcome outcome = remesh(more);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.text.find(why) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(other));
  };
  refused("--out '" + other + "' --only 99", "99 is not recorded; 1 to 3 are");
  refused("--out '" + out + "'", "is the run itself");
  refused("--out '" + other + "' --set /seed=7", "another scene");
  std::filesystem::remove(folder.path() / "out" / "record" / "000002.bin");
  refused("--out '" + other + "'", "has no frame 2");
}

TEST_CASE("closed and full streams: a run goes on without standard error, a lost table is told") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("small.json", small_scene()).string();
  for (const char* where : {"2>&-", "2>/dev/full"}) {
    const std::string out = (folder.path() / "out").string();
    CHECK(run_rend("run '" + scene + "' --no-png --frames 1 --out '" + out + "' " + where + "; exit $?").exit_code == 0);
    CHECK(std::filesystem::exists(folder.path() / "out" / "mesh" / "000001.ply"));
    std::filesystem::remove_all(out);
  }
  const Outcome lost = run_rend("check '" + scene + "' >/dev/full; exit $?");
  CHECK(lost.exit_code == 1);
}
