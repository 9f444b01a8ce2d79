// Islands of the tile solver: sparse matter that steps on nodes of its own.
#include "engine/core/random.h"
#include "engine/mpm/tile_solver.h"
#include "tests/mpm/tile_scenes.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <sstream>

using namespace rend;
using namespace rend::test;

namespace {

// Rubble in all sizes that flies about: single particles, clumps of 2 to 8, and a cloud that is
// one large island.
Model flying_rubble(bool with_cloud) {
  LatticeModel rubble;
  Random random(4, 4);
  const auto noise = [&] { return random.next(-1, 1); };
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 6; ++k) {
        const Vec3 at(6 * i + noise() - 20, 6 * j + noise() + 2, 6 * k + noise() - 20);
        const int side = 1 + (i + 2 * j + 3 * k) % 2;
        rubble.add_box(at, Vec3i(side, 1 + (i + k) % 2, side), 0.5,
                       Vec3(3 * noise(), 3 * noise(), 3 * noise()), 0.2,
                       static_cast<std::uint16_t>((i + j + k) % 2));
        rubble.model.velocity_gradient.back() << 1, -2, 0, 2, 0.5, 1, 0, -1, -1.5;
      }
  if (with_cloud) {
    rubble.add_box(Vec3(30, 2, -20), Vec3i(28, 8, 8), 2.2, Vec3(-1, 0, 0), 0.3);
    rubble.model.velocity_gradient.back() << 1, -2, 0, 2, 0.5, 1, 0, -1, -1.5;
  }
  return rubble.model;
}

SceneDesc rubble_scene() {
  SceneDesc scene = float_scene();
  scene.solver.time_step = 0.01;
  scene.materials[0] = with_surface(scene.materials[0], "von_mises", 8, 4);
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].density = 2;
  scene.materials[1].youngs_modulus = 200;
  return scene;
}

}  // namespace

TEST_CASE("tile: islands follow the reference while they meet, part and fall") {
  for (const Transfer transfer : {Transfer::apic, Transfer::rpic, Transfer::pic}) {
    CAPTURE(static_cast<int>(transfer));
    SceneDesc scene = rubble_scene();
    scene.solver.transfer = transfer;
    scene.solver.rpic_blend = 0.3;
    scene.gravity = Vec3(0, -1, 0.5);
    const Model model = flying_rubble(transfer == Transfer::apic);
    TileSolver tile(scene, model);
    ReferenceSolver reference(scene, model);
    const FrameReport before = tile.snapshot().report;
    std::int64_t steps = 0;
    for (int frame = 0; frame < 3; ++frame) {
      const FrameReport t = tile.advance(0.3), r = reference.advance(0.3);
      REQUIRE(t.status == Status::ok);
      CHECK(t.substeps == r.substeps);
      steps += t.substeps;
      CHECK(close(t.kinetic_energy, r.kinetic_energy, 1e-5));
      CHECK(std::abs(t.elastic_energy - r.elastic_energy) <= 1e-5 * r.kinetic_energy);
      CHECK(close(t.dissipated_energy, r.dissipated_energy, 1e-3));
      CHECK((t.momentum - before.momentum - t.time * t.mass * scene.gravity).norm() <=
            2e-6 * t.mass * t.max_speed);
      const std::vector<TileSolver::Point> points = tile.points();
      const Particles& truth = reference.particles();
      Real x = 0, v = 0, strain = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        x = std::max(x, (points[i].x - truth.x[i]).norm());
        v = std::max(v, (points[i].v - truth.v[i]).norm());
        const Mat3 b = truth.F[i] * truth.F[i].transpose() - Mat3::Identity();
        strain = std::max(strain, (points[i].strain - b).norm());
      }
      CAPTURE(frame);
      CHECK(x <= 2e-5);
      CHECK(v <= 1e-4);
      CHECK(strain <= 1e-4);
    }
    // All of it on islands, some of it alone.
    CHECK(tile.island_steps() + tile.lone_steps() >= steps * tile.snapshot().report.particles / 2);
    CHECK(tile.island_steps() > tile.lone_steps());
    CHECK(tile.lone_steps() > 0);
  }
}

TEST_CASE("tile: islands that meet a body, a floor and the pull tool follow the reference") {
  SceneDesc scene = rubble_scene();
  scene.gravity = Vec3(0, -4, 0);
  scene.colliders.push_back(floor_collider(Contact::separate));
  Model model = flying_rubble(false);
  LatticeModel body;
  body.add_box(Vec3(-10, 3, -10), Vec3i(16, 16, 16), 0.5, Vec3(2, 0, 1), 0.2);
  for (std::size_t i = 0; i < body.model.X.size(); ++i) {
    model.X.push_back(body.model.X[i]);
    model.velocity.push_back(body.model.velocity[i]);
    model.volume.push_back(body.model.volume[i]);
    model.body.push_back(static_cast<std::uint16_t>(model.velocity_gradient.size()));
    model.material.push_back(0);
    model.crease.push_back(0);
  }
  model.velocity_gradient.push_back(Mat3::Zero());
  model.spacing.push_back(0.5);
  TileSolver tile(scene, model);
  ReferenceSolver reference(scene, model);
  for (Solver* solver : {static_cast<Solver*>(&tile), static_cast<Solver*>(&reference)})
    solver->set_pull({Vec3(10, 6, 10), Vec3(0, 30, 0), 5});
  for (int frame = 0; frame < 4; ++frame) {
    const FrameReport t = tile.advance(0.25), r = reference.advance(0.25);
    REQUIRE(t.status == Status::ok);
    // Impacts magnify round-off from frame to frame.
    const Real grown = std::pow(10.0, frame + 1);
    CHECK(close(t.kinetic_energy, r.kinetic_energy, 1e-6 * grown));
    CHECK(std::abs(t.external_work - r.external_work) <= 1e-6 * grown * r.kinetic_energy);
    CHECK((t.momentum - r.momentum).norm() <= 1e-6 * grown * r.mass);
    const Snapshot a = tile.snapshot(), b = reference.snapshot();
    for (std::size_t i = 0; i < a.x.size(); ++i) CHECK((a.x[i] - b.x[i]).norm() <= 1e-5 * grown);
  }
  CHECK(tile.island_steps() > 0);
}

TEST_CASE(
    "tile: islands give the same bits for any threads, AVX2 or AVX-512, and after a restart") {
  SceneDesc scene = rubble_scene();
  scene.gravity = Vec3(0, -1, 0);
  const Model model = flying_rubble(true);
  check_same_bits([&](const TileKernels* kernels, int threads) {
    TileSolver solver(scene, model, kernels);
    solver.advance(0.35);
    std::stringstream file;
    solver.save(file);
    if (threads == 2) {
      TileSolver again(scene, model, kernels);
      again.load(file);
      CHECK(again.advance(0.35).state_hash == solver.advance(0.35).state_hash);
      CHECK(again.island_steps() > 0);
    } else {
      solver.advance(0.35);
    }
    return solver.snapshot().report.state_hash;
  });
}
