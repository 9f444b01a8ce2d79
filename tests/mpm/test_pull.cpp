// The pull tool's spring: stable for any stiffness, within its limit, and it goes with the matter
// it holds.
#include "engine/mpm/pull.h"
#include "engine/mpm/tile_solver.h"
#include "tests/mpm/lattice_model.h"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <sstream>

using namespace rend;

namespace {

PullForce spring(const Vec3& at, const Vec3& target, Real radius, Real stiffness, Real strongest) {
  PullForce pull;
  pull.at = at;
  pull.target = target;
  pull.radius = radius;
  pull.stiffness = stiffness;
  pull.strongest = strongest;
  return pull;
}

Vec3 centre_of(const Solver& solver) {
  const Snapshot s = solver.snapshot();
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : s.x) sum += x;
  return sum / static_cast<Real>(s.x.size());
}

std::unique_ptr<Solver> make(bool tile, SceneDesc scene, const Model& model) {
  scene.solver.precision = tile ? Precision::float32 : Precision::float64;
  if (tile) return std::make_unique<TileSolver>(scene, model);
  return std::make_unique<ReferenceSolver>(scene, model);
}

}  // namespace

TEST_CASE("pull: a spring brings a point mass to its target without overshoot, however stiff") {
  for (const Real stiffness : {1.0, 1e3, 1e6, 1e12}) {
    CAPTURE(stiffness);
    PullForce pull = spring(Vec3::Zero(), Vec3(1, 0, 0), 1, stiffness, 1e300);
    PulledMatter matter{2, 2, Vec3::Zero()};
    constexpr Real dt = 1e-3;
    for (int step = 0; step < 20000; ++step) {
      const Real before = pull.at.x();
      advance_spring(pull, matter, dt);
      matter.momentum += dt * pull.force;
      CHECK_MESSAGE(pull.at.x() >= before - 1e-9, step);
      REQUIRE(pull.at.x() <= 1 + 1e-6);
    }
    CHECK(pull.at.x() == doctest::Approx(1).epsilon(1e-4));
  }
}

TEST_CASE(
    "pull: a spring keeps its limit, holds nothing without matter, and leaves a constant force "
    "alone") {
  PullForce pull = spring(Vec3::Zero(), Vec3(0, 3, 4), 1, 1e4, 10);
  advance_spring(pull, {2, 2, Vec3::Zero()}, 1e-3);
  CHECK(pull.force.norm() == doctest::Approx(10));
  CHECK(pull.force.z() == doctest::Approx(8));
  advance_spring(pull, {}, 1e-3);
  CHECK(pull.force.norm() == 0);
  CHECK(pull.at == Vec3::Zero());
  PullForce constant{Vec3(1, 2, 3), Vec3(0, 5, 0), 1};
  advance_spring(constant, {2, 2, Vec3(9, 9, 9)}, 1e-3);
  CHECK(constant.at == Vec3(1, 2, 3));
  CHECK(constant.force == Vec3(0, 5, 0));
}

TEST_CASE("pull: a free block follows the target in both solvers, and the grip stays on it") {
  for (const bool tile : {false, true}) {
    CAPTURE(tile);
    LatticeModel box;
    box.add_box(Vec3(-1, -1, -1), Vec3i(4, 4, 4), 0.5);
    const auto solver = make(tile, plain_scene(), box.model);
    const Vec3 start = centre_of(*solver);
    solver->set_pull(spring(start, start + Vec3(2, 1, 0), 3, 400, 1e3));
    const FrameReport r = solver->advance(3);
    REQUIRE(r.status == Status::ok);
    CHECK((centre_of(*solver) - start - Vec3(2, 1, 0)).norm() < 0.1);
    CHECK((solver->pull().at - centre_of(*solver)).norm() < 0.1);
    CHECK(solver->pull().force.norm() < 1);
    CHECK(r.momentum.norm() < 0.5);
    CHECK(r.external_work > 0);
  }
}

TEST_CASE("pull: a state file keeps the spring") {
  for (const bool tile : {false, true}) {
    CAPTURE(tile);
    LatticeModel box;
    box.add_box(Vec3(-1, -1, -1), Vec3i(4, 4, 4), 0.5);
    const auto solver = make(tile, plain_scene(), box.model);
    solver->set_pull(spring(Vec3::Zero(), Vec3(2, 1, 0), 2, 100, 50));
    solver->advance(0.2);
    std::stringstream file;
    solver->save(file);
    const FrameReport straight = solver->advance(0.2);
    const auto again = make(tile, plain_scene(), box.model);
    again->load(file);
    CHECK(again->pull().stiffness == 100);
    CHECK(again->advance(0.2).state_hash == straight.state_hash);
  }
}
