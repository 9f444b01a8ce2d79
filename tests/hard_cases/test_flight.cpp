// Single particles, long flight, time steps at and beyond the bound, fast impacts, the far world,
// empty scenes (H5, H7 to H9, H11, H13, H14).
#include "engine/core/error.h"
#include "engine/mpm/energy_balance.h"
#include "tests/effort.h"
#include "tests/hard_cases/hard_run.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

using namespace rend;

namespace {

Real affine_speed(const FrameReport& r) { return std::sqrt(r.affine_energy / r.mass); }

// Particles of a block that tumbles and rings.
LatticeModel tumbling_block(const Vec3& centre, int count, bool spins = true) {
  LatticeModel body;
  body.add_box(centre - Vec3::Constant(0.25 * count), Vec3i(count, count, count), 0.5,
               Vec3(1.5, 0.5, -1), 0.2);
  if (spins) body.spin(0, centre, Vec3(0.1, 0.2, 0.3));
  Mat3 stretch = Mat3::Zero();
  stretch(0, 0) = 0.1;
  stretch(1, 1) = -0.08;
  for (std::size_t p = 0; p < body.model.X.size(); ++p)
    body.model.velocity[p] += stretch * (body.model.X[p] - centre);
  body.model.velocity_gradient[0] += stretch;
  return body;
}

// Of particles of one mass. About the world's origin the lever grows with the way, and with it
// what rounding of positions does.
Vec3 angular_momentum_about_centre(const Snapshot& s) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& x : s.x) centre += x / static_cast<Real>(s.x.size());
  return s.report.angular_momentum - centre.cross(s.report.momentum);
}

}  // namespace

TEST_CASE("H5 a single particle flies straight from every place in a cell") {
  const Real tiny = 1e-15;
  const std::vector<Real> offsets = {0, tiny, 0.25, 0.5 - tiny, 0.5, 0.5 + tiny, 1 - tiny, 2.0 / 3};
  const Vec3 v(0.37, -0.21, 0.53);
  for (const bool near_floor : {false, true})  // nodes are loaded then, not the closed form
    for (const SolverKind& kind : all_solvers()) {
      CAPTURE(kind.name);
      CAPTURE(near_floor);
      LatticeModel all;
      int n = 0;
      for (const Real a : offsets)
        for (const Real b : offsets)
          for (const Real c : offsets) {
            // Far enough apart that none ever shares a node.
            const Vec3 at(8.0 * (n % 8) + a, 8.0 * (n / 8 % 8) + b, 8.0 * (n / 64) + c);
            all.add_box(at - Vec3::Constant(0.25), Vec3i(1, 1, 1), 0.5, v);
            ++n;
          }
      SceneDesc scene = plain_scene();
      scene.solver.time_step = 0.01;
      if (near_floor) {
        // A thin box close by each particle costs too much; one plane that none touches, far too
        // near to be called clear of it, will do for the lowest layer.
        scene.colliders.push_back(plane(Vec3(0, 0, 1), Vec3(0, 0, -2.5), Contact::stick));
      }
      const auto solver = make(kind, scene, all.model);
      const Real start = affine_speed(solver->snapshot().report);
      const Run run = run_frames(*solver, 4, 0.5);
      REQUIRE(run.finished);
      const Snapshot s = solver->snapshot();
      Real worst_v = 0, worst_x = 0;
      for (std::size_t p = 0; p < s.x.size(); ++p) {
        worst_v =
            std::max<Real>(worst_v, (s.v[p].cast<Real>() - v.cast<float>().cast<Real>()).norm());
        worst_x = std::max(worst_x, (s.x[p] - all.model.X[p] - 2 * v).norm());
      }
      const Vec3 drift = run.last.momentum / run.last.mass - v;
      CHECK(drift.norm() <= (kind.reference() ? 200 * 1e-14 : 1e-6));
      CHECK(worst_v <= (kind.reference() ? 1e-7 : 3e-6));
      CHECK(worst_x <= (kind.reference() ? 1e-11 : 1e-5));
      CHECK(start == 0);
      CHECK(affine_speed(run.last) <= (kind.reference() ? 1e-12 : 1e-5));
      note("H5", near_floor ? "512 places in a cell, beside a wall" : "512 places in a cell", kind,
           run, fmt::format("velocity error {:.0e}", drift.norm()));
    }
}

TEST_CASE("H5 particles of tiny mass keep their momentum") {
  for (const SolverKind& kind : main_solvers()) {
    CAPTURE(kind.name);
    SceneDesc scene = plain_scene();
    LatticeModel body = block(Vec3i(4, 4, 4));
    // A mote whose mass the nodes of the block hardly notice, and one alone.
    for (const Vec3& at : {Vec3(1.4, 0.2, 0.1), Vec3(30.3, 0, 0)}) {
      body.add_box(at, Vec3i(1, 1, 1), 0.5, Vec3(0, 1, 0));
      body.model.volume.back() = kind.reference() ? 1e-30 : 1e-20;
    }
    const auto solver = make(kind, scene, body.model);
    const Vec3 before = solver->snapshot().report.momentum;
    const Run run = run_frames(*solver, 5, 0.2);
    REQUIRE(run.finished);
    const Snapshot s = solver->snapshot();
    CHECK(s.v.back()[1] == doctest::Approx(1).epsilon(1e-5));
    CHECK((run.last.momentum - before).norm() <= 1e-12);
    note("H5", "volume 1e-30 (reference) or 1e-20 (tile) cells", kind, run);
  }
}

TEST_CASE("H7 long flight keeps momentum, and energy only falls") {
  struct Row {
    Transfer transfer;
    const char* name;
  };
  const Index steps = test::by_effort(200, 2000, 100000);
  for (const Row& row : {Row{Transfer::apic, "apic"}, Row{Transfer::flip, "flip 1"}})
    for (const SolverKind& kind : main_solvers()) {
      CAPTURE(kind.name);
      CAPTURE(row.name);
      SceneDesc scene = plain_scene();
      scene.solver.transfer = row.transfer;
      scene.solver.flip_ratio = 1;
      scene.solver.time_step = 0.02;
      // FLIP keeps no angular momentum on purpose; see tests/mpm/test_transfer.cpp.
      const bool spins = row.transfer == Transfer::apic;
      LatticeModel body = tumbling_block(Vec3(0.3, 0.2, 0.1), 10, spins);
      const auto solver = make(kind, scene, body.model);
      const FrameReport start = solver->snapshot().report;
      const Vec3 spin = angular_momentum_about_centre(solver->snapshot());
      const int frames = 40;
      Real energy = mechanical_energy(start), rise = 0;
      Run run;
      Index taken = 0;
      for (int n = 0; n < frames; ++n) {
        run = run_frames(*solver, 1, 0.02 * static_cast<Real>(steps) / frames);
        REQUIRE(run.finished);
        taken += run.steps;
        rise = std::max(rise, mechanical_energy(run.last) - energy);
        energy = mechanical_energy(run.last);
      }
      CHECK(taken >= steps);
      const Real p = (run.last.momentum - start.momentum).norm() / start.momentum.norm();
      const Real L =
          (angular_momentum_about_centre(solver->snapshot()) - spin).norm() / spin.norm();
      const Real lost = 1 - energy / mechanical_energy(start);
      // Float: half an ulp a step at random, growing with the square root of the steps.
      CHECK(p <= (kind.reference() ? 1e-11 : 1e-4));
      if (row.transfer == Transfer::apic) {
        CHECK(L <= (kind.reference() ? 1e-11 : 1e-3));
        CHECK(rise <= 1e-3 * mechanical_energy(start));
      } else {
        CHECK(std::abs(lost) < 0.02);
      }
      CHECK(energy_drift(run.last) > -1e-3);
      run.steps = taken;
      note("H7", fmt::format("flight, {}", row.name), kind, run,
           fmt::format("p {:.0e}, L {:.0e}, energy lost {:.1f} %", p, L, 100 * lost));
    }
}

TEST_CASE("H8 steps at 0.5, 0.9, 1.1 and 2 of the bound") {
  for (const Real share : {0.5, 0.9, 1.1, 2.0})
    for (const bool alone : {true, false})
      for (const SolverKind& kind : main_solvers()) {
        CAPTURE(share);
        CAPTURE(alone);
        CAPTURE(kind.name);
        SceneDesc scene = plain_scene();
        const Real bulk = 100 / (3 * 0.4);
        scene.solver.time_step = share * stable_share(scene.solver) / std::sqrt(3 * bulk);
        LatticeModel body = alone ? LatticeModel() : block(Vec3i(6, 6, 6));
        if (alone) body.add_box(Vec3(0.13, 0.29, 0.41), Vec3i(1, 1, 1), 0.5);
        body.model.velocity_gradient[0] << -0.5, 0.2, 0, 0.2, -0.4, 0.1, 0, 0.1, -0.6;
        for (std::size_t p = 0; p < body.model.X.size() && !alone; ++p)
          body.model.velocity[p] = body.model.velocity_gradient[0] * body.model.X[p];
        const auto solver = make(kind, scene, body.model);
        const Real start = mechanical_energy(solver->snapshot().report);
        const Run run = run_frames(*solver, 20, 50 * scene.solver.time_step);
        if (share < 1) {
          CHECK(run.finished);
          // Kinetic and elastic energy swing against each other by a share of dt.
          CHECK(run.most_energy <= (alone ? 10.0 : 1.001) * start);
          if (share == 0.5 || !alone) CHECK(run.least_drift > -kMostEnergyGained);
        }
        if (share == 2.0 || (share > 1 && alone))
          CHECK((!run.finished || run.least_drift < -kMostEnergyGained));
        note("H8", fmt::format("dt = {} of the bound, {}", share, alone ? "one particle" : "block"),
             kind, run,
             fmt::format("E/E0 at most {:.3g}{}", run.most_energy / start,
                         run.least_drift < -kMostEnergyGained ? ", warns of a gain" : ""));
      }
}

TEST_CASE("H9 impacts from Mach 0.3 to 3 do not tunnel") {
  for (const Real mach : {0.3, 1.0, 3.0})
    for (const bool yields : {false, true})
      for (const SolverKind& kind : main_solvers()) {
        CAPTURE(mach);
        CAPTURE(yields);
        CAPTURE(kind.name);
        SceneDesc scene = plain_scene();
        if (yields) scene.materials[0] = with_surface(scene.materials[0], "von_mises", 10, 0);
        const Real c = std::sqrt(100 * 0.7 / (1.3 * 0.4));
        scene.colliders.push_back(plane(Vec3(0, 1, 0), Vec3(0, -2.5, 0), Contact::slip));
        const auto solver = make(kind, scene, block(Vec3i(6, 6, 6), Vec3(0, -mach * c, 0)).model);
        const Run run = run_frames(*solver, 20, 0.05);
        CHECK(run.finished);
        const Snapshot s = solver->snapshot();
        Real lowest = 0;
        for (const Vec3& x : s.x) lowest = std::min(lowest, x[1]);
        CHECK(lowest > -2.5 - 1);
        CHECK(run.least_drift > -kMostEnergyGained);
        CHECK(run.most_energy <= 1.02 * 0.5 * 27 * std::pow(mach * c, 2));
        note("H9", fmt::format("Mach {}, {}", mach, yields ? "von Mises" : "elastic"), kind, run,
             fmt::format("deepest {:.2f} dx into the wall", std::max(0.0, -2.5 - lowest)));
      }
}

TEST_CASE("H11 leaving the domain is a status in each of 26 directions") {
  for (const SolverKind& kind : main_solvers()) {
    CAPTURE(kind.name);
    const Real edge = 4.0 * static_cast<Real>(TileStore::kLimit - 4);
    int stopped = 0;
    for (int n = 0; n < 27; ++n) {
      const Vec3 direction(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      if (direction.norm() == 0) continue;
      LatticeModel one;
      one.add_box(edge * direction, Vec3i(1, 1, 1), 0.5, 40 * direction);
      const auto solver = make(kind, plain_scene(), one.model);
      const Run run = run_frames(*solver, 8, 0.5);
      CHECK_FALSE(run.finished);
      CHECK(run.last.status == Status::left_domain);
      CHECK(run.last.culprit == 0);
      stopped += run.last.status == Status::left_domain;
    }
    // Exactly at the last place that is allowed at the start.
    const Real last = kind.reference() ? BlockGrid::kLimit - 8.0 : 4.0 * (TileStore::kLimit - 2.0);
    LatticeModel border;
    border.add_box(Vec3(std::nextafter(last, 0) - 0.25, -0.25, -0.25), Vec3i(1, 1, 1), 0.5);
    run_frames(*make(kind, plain_scene(), border.model), 2, 0.1);
    border.model.X[0][0] = last;
    CHECK_THROWS_WITH_AS(make(kind, plain_scene(), border.model), doctest::Contains("particle 0"),
                         Error);
    note("H11", "26 directions", kind.name,
         fmt::format("stops: left_domain in {} of 26, last good frame kept", stopped));
  }
}

TEST_CASE("H13 far from the origin everything is as it is near") {
  for (const SolverKind& kind : main_solvers()) {
    CAPTURE(kind.name);
    FrameReport near;
    for (const Real far : {0.0, 1e2, 1e3, 1e4}) {
      CAPTURE(far);
      SceneDesc scene = plain_scene();
      scene.solver.time_step = 0.02;
      // Whole cells, so that the grid lies in the same way.
      const Vec3 centre(far, 0, far);
      const LatticeModel body = tumbling_block(centre, 6);
      const auto solver = make(kind, scene, body.model);
      const Run run = run_frames(*solver, 4, 1);
      REQUIRE(run.finished);
      // About the place where the body was.
      FrameReport r = run.last;
      r.angular_momentum -= centre.cross(r.momentum);
      if (far == 0) near = r;
      const Real energy = std::abs(r.kinetic_energy - near.kinetic_energy) / near.kinetic_energy;
      const Real L =
          (r.angular_momentum - near.angular_momentum).norm() / near.angular_momentum.norm();
      // Rest positions themselves carry 1e-16 of their distance.
      CHECK(energy <= (kind.reference() ? 1e-11 : 3e-6));
      CHECK(L <= (kind.reference() ? 1e-13 + 1e-14 * far : 1e-5));
      if (far > 0)
        note("H13", fmt::format("{:g} cells from the origin", far), kind, run,
             fmt::format("kinetic energy {:.0e}, L {:.0e} off", energy, L));
    }
  }
}

TEST_CASE("H14 no particles, one particle, one step, no time") {
  for (const SolverKind& kind : all_solvers()) {
    CAPTURE(kind.name);
    const auto empty = make(kind, plain_scene(), Model());
    CHECK(run_frames(*empty, 2, 0.1).finished);
    CHECK(empty->time() == doctest::Approx(0.2));
    CHECK(empty->snapshot().x.empty());
    CHECK(empty->advance(0).status == Status::ok);
    SceneDesc loaded = plain_scene();
    loaded.colliders.push_back(plane(Vec3(0, 1, 0), Vec3::Zero(), Contact::slip));
    const auto walls = make(kind, loaded, Model());
    walls->set_pull({Vec3::Zero(), Vec3(1, 0, 0), 1});
    walls->set_gravity(Vec3(0, 1, 0));
    CHECK(run_frames(*walls, 2, 0.1).finished);
    LatticeModel one;
    one.add_box(Vec3::Zero(), Vec3i(1, 1, 1), 0.5);
    const auto single = make(kind, plain_scene(), one.model);
    const Run run = run_frames(*single, 1, 1e-6);
    CHECK(run.finished);
    CHECK(run.steps == 1);
    note("H14", "no particles; one particle; one step; no time", kind, run);
  }
}
