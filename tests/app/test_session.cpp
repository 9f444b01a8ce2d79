// The live session: transport, steering between steps, reset, and what a threshold does to a bar.
#include "app/session.h"
#include "engine/core/error.h"
#include "tests/app/program.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <thread>

using namespace rend;

namespace {

/// The small scene with a fracture energy in place of softening.
std::string energy_scene(const char* tau_c) {
  std::string text = test::small_scene();
  text.replace(text.find("\"softening\": 1e5"), 16, "\"fracture_energy\": 100");
  text.replace(text.find("8e3"), 3, tau_c);
  return text;
}

/// A session on a folder that holds the small scene.
struct Bench {
  test::TemporaryFolder folder;
  std::unique_ptr<Session> session;

  Bench() {
    std::filesystem::create_directory(folder.path() / "scenes");
    folder.write("scenes/small.json", test::small_scene());
    folder.write("scenes/wrong.json", "{}");
    folder.write("scenes/energy.json", energy_scene("8e3"));
    folder.write("scenes/strong.json", energy_scene("1.1e4"));
    session = std::make_unique<Session>(SceneLibrary(folder.path()), "small");
    wait([](const SessionState& s) { return s.last_frame >= 0; });
  }

  template <class Done>
  SessionState wait(Done done) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    SessionState state = session->state();
    while (!done(state) && std::chrono::steady_clock::now() < deadline) state = session->state(state.revision, 1);
    REQUIRE(done(state));
    return state;
  }

  SessionState run_to_end() {
    session->send(Play{});
    return wait([](const SessionState& s) { return s.run == RunState::finished || s.run == RunState::stopped; });
  }
};

const char* kThreshold = "/materials/clay/yield_surface/tau_c";

}  // namespace

TEST_CASE("play, pause, step and reset") {
  Bench bench;
  CHECK(bench.session->state().run == RunState::paused);
  bench.session->send(Step{2});
  SessionState s = bench.wait([](const SessionState& now) { return now.last_frame >= 2; });
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  CHECK(bench.session->state().last_frame == 2);
  bench.session->send(Play{});
  bench.wait([](const SessionState& now) { return now.last_frame >= 4; });
  bench.session->send(Pause{});
  s = bench.wait([](const SessionState& now) { return now.run == RunState::paused; });
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  CHECK(bench.session->state().last_frame == s.last_frame);
  bench.session->send(Reset{});
  s = bench.wait([](const SessionState& now) { return now.last_frame == 0; });
  CHECK(bench.session->frame(0)->frame.snapshot->time == 0);
}

TEST_CASE("a bar tears at its threshold and holds when the threshold is raised while it runs") {
  Bench bench;
  const SessionState torn = bench.run_to_end();
  CHECK(torn.run == RunState::finished);
  // Later on the grips pull matter that cannot yield to twice its length.
  constexpr Index kLooked = 15;
  CHECK(bench.session->frame(kLooked)->frame.fracture.pieces >= 2);
  bench.session->send(Reset{});
  bench.wait([](const SessionState& s) { return s.last_frame == 0; });
  bench.session->send(SetValues{{{kThreshold, 8e5}}});
  bench.run_to_end();
  CHECK(bench.session->frame(kLooked)->frame.fracture.pieces == 1);
  CHECK(bench.session->frame(kLooked)->frame.fracture.broken_edges == 0);
  CHECK(bench.session->command_log().size() >= 2);
}

TEST_CASE("a spring holds its grip, plays, is reported and let go") {
  Bench bench;
  const auto pull_now = [&] { return bench.session->state().pull; };
  SetPull move;
  move.pull.radius = 0.1;
  move.pull.stiffness = 100;
  move.pull.strongest = 20;
  move.pull.target = Vec3(0, 0.2, 0);
  move.keeps_grip = true;
  bench.session->send(move);
  bench.session->send(Step{1});
  bench.wait([](const SessionState& s) { return s.last_frame >= 1; });
  CHECK(pull_now().radius == 0);  // nothing to hold on to

  move.keeps_grip = false;
  bench.session->send(move);
  SessionState s = bench.wait([](const SessionState& now) { return now.last_frame >= 3 && now.pull.radius > 0; });
  CHECK(s.run == RunState::playing);
  CHECK(s.pull.force.y() > 0);
  const Vec3 grip = s.pull.at;
  CHECK(grip.y() > 0);
  move.keeps_grip = true;
  move.pull.target = Vec3(0, -0.2, 0);
  bench.session->send(move);
  s = bench.wait([](const SessionState& now) { return now.pull.target.y() < 0; });
  CHECK((s.pull.at - grip).norm() < 0.1);
  bench.session->send(SetPull{});
  bench.wait([](const SessionState& now) { return now.pull.radius == 0; });
  const std::vector<std::string> log = bench.session->command_log();
  CHECK(std::count_if(log.begin(), log.end(), [](const std::string& l) { return l.find("\"pull\"") != l.npos; }) == 3);
}

TEST_CASE("commands are checked before they are queued") {
  Bench bench;
  CHECK_THROWS_AS(bench.session->send(LoadScene{"../../etc/passwd"}), Error);
  CHECK_THROWS_AS(bench.session->send(SetValues{{{"/materials/clay/colour", 1}}}), Error);
  CHECK_THROWS_AS(bench.session->send(SetValues{{{kThreshold, -1}}}), Error);
  CHECK_THROWS_AS(bench.session->send(SetValues{{{kThreshold, std::nan("")}}}), Error);
}

TEST_CASE("softening follows from the fracture energy when the threshold changes") {
  Bench bench;
  bench.session->send(LoadScene{"energy"});
  const SessionState before =
      bench.wait([](const SessionState& now) { return now.scene_name == "energy" && now.last_frame == 0; });
  const auto softening = [](const SceneDesc& scene) { return scene.materials[0].yield_surface.value[1]; };
  const auto has = [&](const std::string& id) {
    return std::any_of(before.controls.begin(), before.controls.end(), [&](const Control& c) { return c.id == id; });
  };
  CHECK(has("/materials/clay/yield_surface/fracture_energy"));
  CHECK_FALSE(has("/materials/clay/yield_surface/softening"));
  bench.session->send(SetValues{{{kThreshold, 1.1e4}}});
  const SessionState after = bench.wait([&](const SessionState& now) { return now.revision > before.revision; });
  CHECK(softening(after.stage->scene) > 1.4 * softening(before.stage->scene));
  CHECK(softening(after.stage->scene) == softening(bench.session->library().read("strong")));
  // Too little energy for so wide a band: the stress would snap back.
  CHECK_THROWS_WITH_AS(
      bench.session->send(SetValues{{{"/materials/clay/yield_surface/fracture_energy", 5}}}),
      doctest::Contains("the fracture energy of \"clay\" is 5 J/m2"), Error);
}

TEST_CASE("a scene that does not load leaves a message and the next one loads") {
  Bench bench;
  bench.session->send(LoadScene{"wrong"});
  const SessionState s = bench.wait([](const SessionState& now) { return now.run == RunState::stopped; });
  CHECK(s.message.find("wrong.json") != std::string::npos);
  bench.session->send(LoadScene{"small"});
  bench.wait([](const SessionState& now) { return now.run == RunState::paused && now.last_frame == 0; });
}

TEST_CASE("other fracture settings apply to recorded frames without another simulation") {
  Bench bench;
  bench.run_to_end();
  const std::uint64_t hash = bench.session->frame(-1)->frame.snapshot->report.state_hash;
  const Index before = bench.session->frame(-1)->frame.fracture.broken_edges;
  const std::uint64_t data = bench.session->state().data;
  bench.session->send(SetValues{{{"/fracture/gap", 1.5}}});
  bench.wait([&](const SessionState& s) { return s.data > data; });
  CHECK(bench.session->frame(-1)->frame.snapshot->report.state_hash == hash);
  CHECK(bench.session->frame(-1)->frame.fracture.broken_edges < before);
}
