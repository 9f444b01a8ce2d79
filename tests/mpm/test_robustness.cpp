// Thread counts, save and load, the watchdog, live changes, and yielding in the whole solver.
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "tests/mpm/lattice_model.h"

#include <doctest/doctest.h>

#include <sstream>

using namespace rend;

namespace {

// A block that is thrown at a floor and breaks up into rubble.
SceneDesc breaking_scene() {
  SceneDesc scene = plain_scene();
  scene.gravity = Vec3(0, -1, 0);
  scene.materials[0] = with_surface(scene.materials[0], "rankine", 8, 20);
  scene.materials[0].damage.type = DamageType::granular;
  ColliderDesc floor;
  floor.shape = PlaneDesc{Vec3(0, 1, 0)};
  floor.contact = Contact::separate;
  floor.friction = 0.3;
  floor.motion.push_back({});
  scene.colliders.push_back(floor);
  return scene;
}

LatticeModel thrown_block() {
  LatticeModel body;
  body.add_box(Vec3(-2, 0.5, -2), Vec3i(9, 8, 7), 0.5, Vec3(2, -6, 1), 0.2);
  return body;
}

}  // namespace

TEST_CASE("any number of threads gives the same bits") {
  std::uint64_t hash = 0;
  for (int threads : {1, 2, 3, 4}) {
    set_thread_count(threads);
    ReferenceSolver solver(breaking_scene(), thrown_block().model);
    const FrameReport r = solver.advance(0.6);
    REQUIRE(r.status == Status::ok);
    CHECK(r.yielded > 20);
    CHECK(r.damaged > 0);
    CHECK(r.dissipated_energy > 0);
    if (threads == 1) hash = r.state_hash;
    CHECK(r.state_hash == hash);
  }
  set_thread_count(0);
}

TEST_CASE("save and load continue with the same bits, damaged files are refused") {
  ReferenceSolver a(breaking_scene(), thrown_block().model);
  a.advance(0.3);
  std::stringstream file;
  a.save(file);
  const FrameReport straight = a.advance(0.3);

  ReferenceSolver b(breaking_scene(), thrown_block().model);
  b.load(file);
  CHECK(b.time() == doctest::Approx(0.3));
  const FrameReport resumed = b.advance(0.3);
  CHECK(resumed.state_hash == straight.state_hash);
  CHECK(resumed.dissipated_energy == straight.dissipated_energy);
  CHECK(resumed.substeps == straight.substeps);

  const std::string bytes = file.str();
  ReferenceSolver c(breaking_scene(), thrown_block().model);
  const std::uint64_t untouched = c.snapshot().report.state_hash;
  for (std::size_t length : {std::size_t(0), std::size_t(20), bytes.size() / 2, bytes.size() - 1}) {
    std::stringstream cut(bytes.substr(0, length));
    CHECK_THROWS_AS(c.load(cut), Error);
  }
  for (std::size_t at :
       {std::size_t(3), std::size_t(9), std::size_t(40), bytes.size() / 2, bytes.size() - 1}) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    std::stringstream damaged(flipped);
    CHECK_THROWS_AS(c.load(damaged), Error);
  }
  SceneDesc other = breaking_scene();
  other.grid.dx = 0.9;
  ReferenceSolver d(other, thrown_block().model);
  std::stringstream foreign(bytes);
  CHECK_THROWS_WITH_AS(d.load(foreign), doctest::Contains("another scene"), Error);
  CHECK(c.advance(1e-9).status == Status::ok);
  ReferenceSolver e(breaking_scene(), thrown_block().model);
  CHECK(e.snapshot().report.state_hash == untouched);
}

TEST_CASE("a velocity that is not a number is found with its particle") {
  LatticeModel body = thrown_block();
  body.model.velocity[123][1] = std::nan("");
  ReferenceSolver solver(breaking_scene(), body.model);
  const FrameReport r = solver.advance(0.1);
  CHECK(r.status == Status::not_finite);
  CHECK(r.culprit == 123);
  CHECK(r.reason.find("123") != std::string::npos);
  CHECK(r.substeps == 0);
}

TEST_CASE("after numerical trouble the last good frame is back and the run can go on") {
  ReferenceSolver solver(breaking_scene(), thrown_block().model);
  const FrameReport good = solver.advance(0.2);
  solver.set_gravity(Vec3(0, std::nan(""), 0));
  const FrameReport bad = solver.advance(0.2);
  CHECK(bad.status == Status::not_finite);
  CHECK(bad.culprit >= 0);
  CHECK(solver.time() == good.time);
  CHECK(bad.state_hash == good.state_hash);
  solver.set_gravity(Vec3(0, -1, 0));
  CHECK(solver.advance(0.2).status == Status::ok);
}

TEST_CASE("a step that is too long stops with a reason instead of a crash") {
  SceneDesc scene = plain_scene();
  LatticeModel body = thrown_block();
  Random random(1, 1);
  for (Vec3& v : body.model.velocity) v += Vec3(random.next(), random.next(), random.next());
  scene.solver.time_step = 2.5 / std::sqrt(100 * 1.346);
  ReferenceSolver solver(scene, body.model);
  FrameReport r;
  for (int frame = 0; frame < 40 && r.status == Status::ok; ++frame) r = solver.advance(2);
  CHECK(r.status != Status::ok);
  CHECK_FALSE(r.reason.empty());
  CHECK(solver.snapshot().report.kinetic_energy < 1e300);
}

TEST_CASE("a particle that crosses more than a cell in a step is too fast") {
  SceneDesc scene = plain_scene();
  scene.solver.time_step = 0.01;
  for (Real speed : {95.0, 105.0}) {
    LatticeModel one;
    one.add_box(Vec3::Zero(), Vec3i(1, 1, 1), 0.5, Vec3(0, speed, 0));
    ReferenceSolver solver(scene, one.model);
    const FrameReport r = solver.advance(0.05);
    CHECK((r.status == Status::too_fast) == (speed > 100));
    if (speed > 100) CHECK(r.culprit == 0);
    if (speed > 100) CHECK(solver.particles().x[0] == one.model.X[0]);
  }
}

TEST_CASE("leaving the domain is a status in every direction") {
  const Real edge = BlockGrid::kLimit - 10.0;
  for (int n = 0; n < 27; ++n) {
    const Vec3 direction(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    if (direction.norm() == 0) continue;
    LatticeModel one;
    one.add_box(edge * direction, Vec3i(1, 1, 1), 0.5, 40 * direction);
    ReferenceSolver solver(plain_scene(), one.model);
    const FrameReport r = solver.advance(1);
    CHECK(r.status == Status::left_domain);
    CHECK(r.culprit == 0);
    CHECK(r.time == 0);
  }
  LatticeModel outside;
  outside.add_box(Vec3(0, 2e6, 0), Vec3i(1, 1, 1), 0.5);
  CHECK_THROWS_WITH_AS(ReferenceSolver(plain_scene(), outside.model), doctest::Contains("2^20"),
                       Error);
}

TEST_CASE("no particles, and one particle for one step") {
  ReferenceSolver empty(plain_scene(), Model());
  CHECK(empty.advance(0.1).status == Status::ok);
  CHECK(empty.time() == doctest::Approx(0.1));
  LatticeModel one;
  one.add_box(Vec3::Zero(), Vec3i(1, 1, 1), 0.5);
  ReferenceSolver solver(plain_scene(), one.model);
  CHECK(solver.advance(1e-6).status == Status::ok);
}

TEST_CASE("compression does not yield Rankine matter, tension does") {
  for (Real sign : {-1.0, 1.0}) {
    SceneDesc scene = plain_scene();
    scene.materials[0] = with_surface(scene.materials[0], "rankine", 3, 0);
    LatticeModel bar;
    bar.add_box(Vec3(-4, -1, -1), Vec3i(16, 4, 4), 0.5);
    for (Real side : {-1.0, 1.0}) {
      ColliderDesc grip;
      grip.shape = BoxDesc{Vec3(2, 6, 6)};
      grip.contact = Contact::stick;
      grip.motion = {{0, Vec3(side * 4, 0, 0), Vec3::Zero()},
                     {6, Vec3(side * (4 + sign * 0.4), 0, 0), Vec3::Zero()}};
      scene.colliders.push_back(grip);
    }
    ReferenceSolver solver(scene, bar.model);
    const FrameReport r = solver.advance(6);
    REQUIRE(r.status == Status::ok);
    if (sign < 0)
      CHECK(r.yielded == 0);
    else
      CHECK(r.yielded > 20);
  }
}

TEST_CASE("set_material scales the softened thresholds") {
  SceneDesc scene = breaking_scene();
  scene.materials[0].damage.type = DamageType::off;
  ReferenceSolver solver(scene, thrown_block().model);
  solver.advance(0.6);
  const std::vector<Real> before = solver.particles().tau_c;
  CHECK(*std::min_element(before.begin(), before.end()) < 7.9);
  MaterialDesc stronger = scene.materials[0];
  stronger.yield_surface.value[0] = 16;
  solver.set_material(0, stronger);
  for (std::size_t p = 0; p < before.size(); ++p)
    CHECK(solver.particles().tau_c[p] == doctest::Approx(2 * before[p]).epsilon(1e-12));
  CHECK(solver.advance(0.1).status == Status::ok);
}

TEST_CASE("strength varies per particle") {
  SceneDesc scene = breaking_scene();
  LatticeModel body = thrown_block();
  body.model.strength.assign(body.model.X.size(), 1.0f);
  body.model.strength[5] = 0.5f;
  ReferenceSolver solver(scene, body.model);
  CHECK(solver.particles().tau_c[5] == 4);
  CHECK(solver.particles().tau_c[6] == 8);
}

TEST_CASE("an advance can be cut short between steps") {
  ReferenceSolver solver(plain_scene(), thrown_block().model);
  int calls = 0;
  const FrameReport r = solver.advance(1, [&] { return ++calls < 3; });
  CHECK(r.substeps == 3);
  CHECK(solver.time() < 1);
  CHECK(r.status == Status::ok);
}
