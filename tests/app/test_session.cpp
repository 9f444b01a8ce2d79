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

/// A session on a folder that holds the small scene.
struct Bench {
  test::TemporaryFolder folder;
  std::unique_ptr<Session> session;

  Bench() {
    std::filesystem::create_directory(folder.path() / "scenes");
    folder.write("scenes/small.json", test::small_scene());
    folder.write("scenes/wrong.json", "{}");
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
