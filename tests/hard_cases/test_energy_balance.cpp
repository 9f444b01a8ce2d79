// The balance sheet closes: free fall, a ringing bar, friction, a torn bar, live changes.
#include "bench/problems/kuhn_model.h"
#include "engine/mesh/build_model.h"
#include "engine/mpm/energy_balance.h"
#include "tests/hard_cases/hard_run.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

using namespace rend;

namespace {

constexpr Real kPi = 3.14159265358979323846;

// A bar along x in its first free-free mode, strain amplitude `strain`.
LatticeModel ringing_bar(Real strain) {
  LatticeModel bar;
  bar.add_box(Vec3(0, 0, 0), Vec3i(48, 6, 6), 0.5);
  const Real k = kPi / 24, c = std::sqrt(100.0);
  for (std::size_t p = 0; p < bar.model.X.size(); ++p)
    bar.model.velocity[p] = Vec3(strain * c * std::cos(k * bar.model.X[p][0]), 0, 0);
  return bar;
}

}  // namespace

TEST_CASE("balance: free fall leaves no remainder, at any step") {
  for (const SolverKind& kind : all_solvers())
    for (const Real dt : {0.0, 0.02}) {
      CAPTURE(kind.name);
      SceneDesc scene = plain_scene();
      scene.gravity = Vec3(0.5, -9.81, 0);
      scene.solver.time_step = dt;
      const auto solver = make(kind, scene, block(Vec3i(6, 6, 6), Vec3(1, 2, 3)).model);
      const Run run = run_frames(*solver, 10, 0.2);
      REQUIRE(run.finished);
      CHECK(std::abs(energy_drift(run.last)) <= (kind.reference() ? 1e-12 : 1e-5));
    }
}

TEST_CASE("balance: a ringing bar gains nothing and its swing does not show") {
  for (const SolverKind& kind : main_solvers()) {
    CAPTURE(kind.name);
    SceneDesc scene = plain_scene();
    scene.materials[0].poisson_ratio = 0;
    scene.solver.time_step = 0.05;
    const auto solver = make(kind, scene, ringing_bar(0.01).model);
    // Four periods of 48 m / c, sixteen frames each.
    Real worst = 0, lost = 0, swing = 0;
    const Real start = mechanical_energy(solver->snapshot().report);
    for (int n = 0; n < 64; ++n) {
      const FrameReport r = solver->advance(4.8 / 16);
      REQUIRE(r.status == Status::ok);
      worst = std::min(worst, energy_drift(r) - lost);
      lost = std::max(lost, energy_drift(r));
      swing = std::max(swing, r.elastic_energy / start);
    }
    CHECK(swing > 0.8);    // it does ring
    CHECK(worst > -1e-3);  // the remainder only grows
    CHECK(lost < 0.01);
    note("balance", "ringing bar, 4 periods of 24 cells", kind.name,
         fmt::format("transfer loss {:.2f} %, never gains more than {:.3f} %", 100 * lost,
                     -100 * worst));
  }
}

TEST_CASE("balance: PIC damps, and all of it is transfer loss") {
  for (const SolverKind& kind : main_solvers()) {
    SceneDesc scene = plain_scene();
    scene.solver.transfer = Transfer::pic;
    const auto solver = make(kind, scene, ringing_bar(0.01).model);
    const Real start = mechanical_energy(solver->snapshot().report);
    const Run run = run_frames(*solver, 20, 1);
    CHECK(mechanical_energy(run.last) < 0.2 * start);
    CHECK(run.last.dissipated_energy == 0);
    CHECK(run.last.transfer_loss > 0.8 * start);
    CHECK(energy_warning(run.last).find("damped") != std::string::npos);
  }
}

TEST_CASE("balance: friction takes what sliding loses") {
  for (const SolverKind& kind : main_solvers()) {
    CAPTURE(kind.name);
    SceneDesc scene = plain_scene();
    scene.gravity = Vec3(0, -2, 0);
    scene.colliders.push_back(plane(Vec3(0, 1, 0), Vec3(0, -1, 0), Contact::slip, 0.3));
    const auto solver = make(kind, scene, block(Vec3i(12, 4, 12), Vec3(3, 0, 0)).model);
    const Run run = run_frames(*solver, 20, 0.2);
    REQUIRE(run.finished);
    // Stops after v / (mu g) = 5 s: at 4 s most of the energy is gone, by friction.
    const Real lost = 0.5 * run.last.mass * 9 - run.last.kinetic_energy;
    CHECK(run.last.friction_energy == doctest::Approx(lost).epsilon(0.05));
    CHECK(run.last.external_work == 0);
    CHECK(std::abs(energy_drift(run.last)) < 0.05);
  }
}

TEST_CASE("balance: a torn bar closes, with particle and with mesh forces") {
  for (const bool mesh : {false, true})
    for (const SolverKind& kind : main_solvers()) {
      CAPTURE(mesh);
      CAPTURE(kind.name);
      SceneDesc scene = plain_scene();
      scene.materials[0] = with_surface(scene.materials[0], "rankine", 5, 12);
      scene.materials[0].damage.type = DamageType::granular;
      BodyDesc body;
      body.force = mesh ? ForceKind::mesh : ForceKind::particle;
      scene.bodies.push_back(body);
      scene.colliders = grips(4, 0.04, 16);
      const Model model = kuhn_box(Vec3(-4, -1, -1), Vec3i(16, 4, 4), 0.5);
      const auto solver = make(kind, scene, model);
      Real dissipated = 0;
      bool monotone = true;
      FrameReport r;
      for (int n = 0; n < 16; ++n) {
        r = solver->advance(1);
        REQUIRE(r.status == Status::ok);
        monotone = monotone && r.dissipated_energy >= dissipated;
        dissipated = r.dissipated_energy;
      }
      CHECK(monotone);
      CHECK(r.damaged > 0);
      CHECK(dissipated > 0.5 * r.external_work);
      CHECK(r.transfer_loss > -0.02 * r.external_work);
      CHECK(r.transfer_loss < 0.15 * r.external_work);
      note("balance", mesh ? "torn bar, mesh forces" : "torn bar, particle forces", kind.name,
           fmt::format(
               "dissipated {:.1f} %, elastic {:.1f} %, transfer loss {:.1f} % of the external work",
               100 * dissipated / r.external_work, 100 * r.elastic_energy / r.external_work,
               100 * r.transfer_loss / r.external_work));
    }
}

TEST_CASE("balance: work of the pull tool, and live changes leave no remainder") {
  for (const SolverKind& kind : main_solvers()) {
    CAPTURE(kind.name);
    SceneDesc scene = plain_scene();
    scene.gravity = Vec3(0, -1, 0);
    const auto solver = make(kind, scene, block(Vec3i(8, 8, 8), Vec3(1, 0, 0)).model);
    solver->set_pull({Vec3(1, 0, 0), Vec3(20, 0, 0), 3});
    FrameReport r = solver->advance(0.5);
    CHECK(r.external_work > 1);
    CHECK(std::abs(r.transfer_loss) < 0.1 * r.external_work);
    solver->set_pull({});
    const Real before = r.transfer_loss;
    solver->set_gravity(Vec3(0, -5, 3));
    MaterialDesc heavy = scene.materials[0];
    heavy.density = 2;
    heavy.youngs_modulus = 300;
    solver->set_material(0, heavy);
    r = solver->advance(1e-6);
    CHECK(std::abs(r.transfer_loss - before) < 1e-3 * r.energy_turnover);
  }
}

TEST_CASE("balance: a pull against stiff matter puts in what the matter gets") {
  for (const SolverKind& kind : main_solvers()) {
    CAPTURE(kind.name);
    const auto solver = make(kind, plain_scene(), block(Vec3i(16, 8, 8), Vec3(0, 0, 0)).model);
    PullForce pull;
    pull.at = Vec3(4, 0, 0), pull.target = Vec3(8, 4, 0), pull.radius = 1.5;
    pull.stiffness = 20, pull.strongest = 60;
    solver->set_pull(pull);
    for (int n = 0; n < 20; ++n) {
      const FrameReport r = solver->advance(0.1);
      REQUIRE(r.status == Status::ok);
      CHECK(energy_drift(r) > -0.01);
    }
  }
}

TEST_CASE("balance: a run whose step is too long says that it gains") {
  SceneDesc scene = plain_scene();
  scene.solver.time_step = 1.1 / std::sqrt(3 * 100 / (3 * 0.4));
  LatticeModel one;
  one.add_box(Vec3(0.13, 0.29, 0.41), Vec3i(1, 1, 1), 0.5);
  one.model.velocity_gradient[0] << -0.5, 0.2, 0, 0.2, -0.4, 0.1, 0, 0.1, -0.6;
  ReferenceSolver solver(scene, one.model);
  CHECK(energy_warning(solver.snapshot().report).empty());
  const FrameReport r = solver.advance(200 * scene.solver.time_step);
  CHECK(energy_drift(r) < -kMostEnergyGained);
  CHECK(energy_warning(r).find("lower cfl") != std::string::npos);
}
