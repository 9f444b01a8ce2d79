// What explicit MPM conserves, and motions with exact answers.
#include "tests/mpm/lattice_model.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

// A jittered box that is shaken: random velocities make it vibrate while it flies and turns.
LatticeModel shaken_box(Real shake) {
  LatticeModel body;
  body.add_box(Vec3(-2, -1.5, -1), Vec3i(8, 6, 4), 0.5, Vec3(0.7, -0.3, 0.2), 0.3);
  body.spin(0, Vec3::Zero(), Vec3(0.1, 0.2, -0.15));
  Random random(9, 9);
  for (Vec3& v : body.model.velocity)
    v += shake * Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
  return body;
}

}  // namespace

TEST_CASE("a shaken body in free flight keeps mass, momentum and, with APIC, angular momentum") {
  for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic})
    for (ForceForm form : {ForceForm::mls, ForceForm::gradient}) {
      CAPTURE(static_cast<int>(transfer));
      CAPTURE(static_cast<int>(form));
      SceneDesc scene = plain_scene();
      scene.solver.transfer = transfer;
      scene.solver.force_form = form;
      if (form == ForceForm::gradient) scene.solver.kernel = Kernel::cubic;
      ReferenceSolver solver(scene, shaken_box(0.5).model);
      const FrameReport before = solver.snapshot().report;
      FrameReport after;
      Index steps = 0;
      while (steps < 1000) {
        after = solver.advance(100 * solver.stable_time_step());
        REQUIRE(after.status == Status::ok);
        steps += after.substeps;
      }
      CHECK(after.mass == before.mass);
      CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
      if (transfer == Transfer::apic)
        CHECK((after.angular_momentum - before.angular_momentum).norm() <
              1e-11 * before.angular_momentum.norm());
      CHECK(total_energy(after) < total_energy(before) * (1 + 1e-9));
      CHECK(after.elastic_energy > 0);
    }
}

TEST_CASE("free fall is x0 + v0 t + g t (t + dt) / 2") {
  SceneDesc scene = plain_scene();
  scene.gravity = Vec3(0.3, -9.81, 0.1);
  scene.solver.time_step = 0.004;
  LatticeModel body;
  const Vec3 v0(1, 2, -0.5);
  body.add_box(Vec3(0, 0, 0), Vec3i(5, 4, 3), 0.5, v0, 0.3);
  for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic}) {
    scene.solver.transfer = transfer;
    ReferenceSolver solver(scene, body.model);
    solver.advance(0.8);
    const Real t = solver.time(), dt = scene.solver.time_step;
    CHECK(t == doctest::Approx(0.8).epsilon(1e-14));
    const Vec3 path = v0 * t + scene.gravity * t * (t + dt) / 2;
    for (std::size_t p = 0; p < body.model.X.size(); ++p)
      REQUIRE((solver.particles().x[p] - body.model.X[p] - path).norm() < 1e-12 * path.norm());
  }
}

TEST_CASE("APIC keeps a body turning, PIC stops it") {
  const auto turn = [](Transfer transfer) {
    SceneDesc scene = plain_scene();
    scene.solver.transfer = transfer;
    scene.materials[0].youngs_modulus = 1000;
    LatticeModel body;
    body.add_box(Vec3(-4, -4, -1), Vec3i(16, 16, 4), 0.5, Vec3::Zero(), 0, 0,
                 [](const Vec3& x) { return std::hypot(x[0], x[1]) < 4; });
    const Real w = 1;
    body.spin(0, Vec3::Zero(), Vec3(0, 0, w));
    ReferenceSolver solver(scene, body.model);
    const FrameReport before = solver.snapshot().report;
    const FrameReport after = solver.advance(2 * 3.14159265358979 / w / 4);
    CHECK(after.status == Status::ok);
    return std::pair(after.kinetic_energy / before.kinetic_energy,
                     after.angular_momentum[2] / before.angular_momentum[2]);
  };
  const auto [apic_energy, apic_spin] = turn(Transfer::apic);
  CHECK(apic_energy > 0.98);
  CHECK(std::abs(apic_spin - 1) < 1e-12);
  CHECK(turn(Transfer::pic).first < 0.5);
}

TEST_CASE("FLIP with ratio 0 is PIC to the bit") {
  SceneDesc scene = plain_scene();
  scene.solver.transfer = Transfer::flip;
  scene.solver.flip_ratio = 0;
  scene.solver.time_step = 0.01;
  ReferenceSolver flip(scene, shaken_box(0.5).model);
  scene.solver.transfer = Transfer::pic;
  ReferenceSolver pic(scene, shaken_box(0.5).model);
  CHECK(flip.advance(0.5).state_hash == pic.advance(0.5).state_hash);
}

TEST_CASE("two blocks that collide keep momentum and come apart") {
  SceneDesc scene = plain_scene();
  LatticeModel blocks;
  blocks.add_box(Vec3(-4, 0, 0), Vec3i(6, 6, 6), 0.5, Vec3(1, 0, 0));
  blocks.add_box(Vec3(1, 0.25, 0), Vec3i(6, 6, 6), 0.5, Vec3(-1, 0, 0));
  ReferenceSolver solver(scene, blocks.model);
  const FrameReport before = solver.snapshot().report;
  Real most_elastic = 0;
  FrameReport after;
  for (int frame = 0; frame < 40; ++frame) {
    after = solver.advance(0.1);
    REQUIRE(after.status == Status::ok);
    most_elastic = std::max(most_elastic, after.elastic_energy);
    CHECK(total_energy(after) <= total_energy(before) * (1 + 1e-9));
  }
  CHECK(most_elastic > 0.2 * before.kinetic_energy);
  CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.kinetic_energy);
  CHECK((after.angular_momentum - before.angular_momentum).norm() < 1e-11 * before.kinetic_energy);
  // The first block now flies back.
  Real v = 0;
  for (std::size_t p = 0; p < 216; ++p) v += solver.particles().v[p][0] / 216;
  CHECK(v < -0.3);
}

TEST_CASE("two materials of different density and stiffness share the grid") {
  SceneDesc scene = plain_scene();
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].density = 4;
  scene.materials[1].youngs_modulus = 1e4;
  LatticeModel blocks;
  blocks.add_box(Vec3(-4, 0, 0), Vec3i(4, 4, 4), 0.5, Vec3(1, 0, 0), 0, 0);
  blocks.add_box(Vec3(-1.5, 0, 0), Vec3i(4, 4, 4), 0.5, Vec3(-1, 0, 0), 0, 1);
  ReferenceSolver solver(scene, blocks.model);
  const FrameReport before = solver.snapshot().report;
  CHECK(before.mass == doctest::Approx(8 + 32));
  const FrameReport after = solver.advance(1.5);
  CHECK(after.status == Status::ok);
  CHECK((after.momentum - before.momentum).norm() < 1e-11 * before.momentum.norm());
}

TEST_CASE("flying apart does not slow down: the grid exists only where particles are") {
  SceneDesc scene = plain_scene();
  LatticeModel debris;
  Random random(4, 4);
  for (int n = 0; n < 200; ++n)
    debris.add_box(1e4 * Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)),
                   Vec3i(1, 1, 1), 0.5,
                   Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)));
  ReferenceSolver solver(scene, debris.model);
  REQUIRE(solver.advance(0.5).status == Status::ok);
  CHECK(solver.bytes_per_particle() < 8 * 64 * 120);
  for (std::size_t p = 0; p < debris.model.X.size(); ++p) {
    // Alone in space a particle flies on exactly, at any place within its cell.
    const Vec3 flown = solver.particles().x[p] - debris.model.X[p];
    CHECK((flown - 0.5 * debris.model.velocity[p]).norm() < 1e-10);
    CHECK((solver.particles().v[p] - debris.model.velocity[p]).norm() < 1e-13);
  }
}
