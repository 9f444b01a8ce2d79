// Checkpoints: a run that was cut short goes on with the same bits; damaged files are told, never trusted.
#include "app/checkpoint.h"
#include "engine/core/error.h"
#include "engine/scene/scene_reader.h"
#include "tests/app/program.h"

#include <doctest/doctest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <vector>

using namespace rend::test;

namespace {

std::string read(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// The columns of a table that do not tell wall time.
std::string without_seconds(const std::string& table) {
  std::istringstream lines(table);
  std::string line, out;
  std::set<std::size_t> clocks;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (std::size_t n = 0; std::getline(cells, cell, ','); ++n) {
      if (cell.ends_with("_seconds")) clocks.insert(n);
      if (!clocks.contains(n)) out += cell + ",";
    }
    out += "\n";
  }
  return out;
}

struct RunFolder {
  TemporaryFolder folder;
  std::filesystem::path scene, out;

  explicit RunFolder(const std::string& extra = "")
      : scene(folder.write("small.json", small_scene(extra))), out(folder.path() / "out") {}
  Outcome run(const std::string& options) const {
    return run_rend("run '" + scene.string() + "' --no-png --out '" + out.string() + "' " + options);
  }
  Outcome resume(const std::string& options = "") const {
    return run_rend("run --no-png --resume '" + out.string() + "' " + options);
  }
};

}  // namespace

TEST_CASE("a run that was cut short goes on with the same bits, on both solvers") {
  for (const char* precision : {"float", "double"}) {
    CAPTURE(precision);
    const std::string extra = std::string(R"(, "solver": {"precision": ")") + precision + "\"}";
    const RunFolder whole(extra), cut(extra);
    REQUIRE(whole.run("--frames 26").exit_code == 0);
    REQUIRE(cut.run("--frames 23 --checkpoint-every 8").exit_code == 0);
    CHECK(std::filesystem::exists(cut.out / "checkpoint" / "000016.bin"));
    CHECK(std::filesystem::exists(cut.out / "checkpoint" / "000008.bin"));
    const Outcome rest = cut.resume("--frames 26");
    CAPTURE(rest.text);
    REQUIRE(rest.exit_code == 0);
    CHECK(rest.text.find("going on after frame 16") != std::string::npos);
    CHECK(without_seconds(read(whole.out / "frames.csv")) == without_seconds(read(cut.out / "frames.csv")));
    CHECK(read(whole.out / "mesh/000026.ply") == read(cut.out / "mesh/000026.ply"));
    CHECK(read(whole.out / "mesh/000026.ply").size() > 1000);
    CHECK(cut.resume("--frames 16").text.find("nothing to do") != std::string::npos);
  }
}

TEST_CASE("a damaged checkpoint falls back to the one before, and says so") {
  const RunFolder run;
  REQUIRE(run.run("--frames 12 --checkpoint-every 4").exit_code == 0);
  const auto newest = run.out / "checkpoint" / "000012.bin", before = run.out / "checkpoint" / "000008.bin";
  CHECK_FALSE(std::filesystem::exists(run.out / "checkpoint" / "000004.bin"));
  const std::string good = read(newest), table = read(run.out / "frames.csv");
  write(newest, good.substr(0, good.size() / 2));
  Outcome rest = run.resume("--frames 12");
  CHECK(rest.exit_code == 0);
  CHECK(rest.text.find("cut short; trying the one before") != std::string::npos);
  CHECK(without_seconds(read(run.out / "frames.csv")) == without_seconds(table));

  write(newest, "");
  write(before, good.substr(0, 100));
  rest = run.resume();
  CHECK(rest.exit_code == 2);
  CHECK(rest.text.find("000012.bin") != std::string::npos);
}

TEST_CASE("what cannot be resumed is refused in one line") {
  const RunFolder run;
  REQUIRE(run.run("--frames 4 --checkpoint-every 2").exit_code == 0);
  const auto refused = [&](const Outcome& outcome, const char* said) {
    CAPTURE(outcome.text);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.text.find(said) != std::string::npos);
  };
  const std::string scene = read(run.out / "scene.json");
  std::string other = scene;
  const std::size_t at = other.find("8000");
  REQUIRE(at != std::string::npos);
  write(run.out / "scene.json", other.replace(at, 4, "9000"));
  refused(run.resume(), "belongs to another scene");
  write(run.out / "scene.json", scene);
  std::filesystem::remove(run.out / "record" / "000003.bin");
  refused(run.resume("--frames 6"), "000003.bin");
  std::filesystem::remove_all(run.out / "checkpoint");
  refused(run.resume(), "holds no checkpoints");
  refused(run_rend("run --resume '" + (run.folder.path() / "nowhere").string() + "'"), "nowhere");
  refused(run.run("--checkpoint-every 2 --no-record"), "--no-record");
  refused(run_rend("run --resume x small.json"), "SCENE");
  refused(run_rend("run --resume x --set /grid/dx=1"), "--set");
}

TEST_CASE("no cut or flipped checkpoint file is taken for a whole one") {
  const TemporaryFolder folder;
  const rend::SceneDesc scene = rend::parse_scene(small_scene(), "small", ".");
  const std::uint64_t hash = rend::motion_hash(scene);
  const std::string state(2000, 'x');
  rend::write_checkpoint(folder.path(), {7, state}, hash);
  const auto file = rend::checkpoint_files(folder.path()).at(0);
  const std::string good = read(file);
  const rend::Checkpoint back = rend::read_checkpoint(file, hash);
  CHECK(back.frame == 7);
  CHECK(back.state == state);
  CHECK_THROWS_AS(rend::read_checkpoint(file, hash + 1), rend::Error);
  const auto refuses = [&](const std::string& bytes) {
    write(file, bytes);
    CHECK_THROWS_AS(rend::read_checkpoint(file, hash), rend::Error);
  };
  for (std::size_t n = 0; n < good.size(); n += n < 60 ? 1 : 13) refuses(good.substr(0, n));
  for (std::size_t n = 0; n < good.size(); n += n < 60 ? 1 : 11) {
    std::string flipped = good;
    flipped[n] = static_cast<char>(flipped[n] ^ (1 << (n % 8)));
    refuses(flipped);
  }
  refuses(good + "x");
}

TEST_CASE("the energies of a run add up in frames.csv and in what rend run says") {
  const RunFolder run;
  const Outcome said = run.run("--frames 26 --no-record");
  REQUIRE(said.exit_code == 0);
  CHECK(said.text.find("transfer loss") != std::string::npos);
  double put_in = 0;
  std::istringstream table(read(run.out / "frames.csv"));
  std::string line;
  std::vector<std::string> names;
  double worst = 0;
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::map<std::string, double> row;
    std::string cell;
    const bool header = names.empty();
    for (std::size_t n = 0; std::getline(cells, cell, ','); ++n) {
      if (header) names.push_back(cell);
      else if (names[n] != "state_hash") row[names[n]] = std::stod(cell);
    }
    if (header) continue;
    // Starts from rest without gravity: all energy comes from the grips.
    const double there = row["kinetic_energy"] + row["affine_energy"] + row["elastic_energy"] + row["gravity_energy"];
    const double gone = row["dissipated_energy"] + row["friction_energy"] + row["transfer_loss"];
    worst = std::max(worst, std::abs(row["external_work"] - there - gone));
    put_in = row["external_work"];
  }
  // The half step that brings velocities to the end of the step.
  CHECK(put_in > 0);
  CHECK(worst < 0.02 * put_in);
}

TEST_CASE("a run that gains energy says so") {
  const RunFolder run(R"(, "solver": {"precision": "double", "time_step": 0.0075})");
  const Outcome said = run.run("--frames 20");
  CAPTURE(said.text);
  const bool stopped = said.exit_code == 4 && said.text.find("stopped in frame") != std::string::npos;
  CHECK((stopped || said.text.find("warning: The run has gained") != std::string::npos));
}
