// Mesh forces on the tile solver: against the reference, bits, momenta, damage, files.
#include "engine/mpm/tile_solver.h"
#include "tests/mpm/mesh_model.h"
#include "tests/mpm/tile_scenes.h"

#include <doctest/doctest.h>

#include <Eigen/LU>

#include <cmath>
#include <sstream>

using namespace rend;

namespace {

SceneDesc float_mesh_scene() {
  SceneDesc scene = mesh_scene();
  scene.solver.precision = Precision::float32;
  scene.solver.time_step = 0.01;
  return scene;
}

// A bar that is drawn, sheared and flies; numbers that float holds exactly.
Model drawn_bar(const Vec3i& cells, Real spacing) {
  Model model = kuhn_box(Vec3(-3.25, 5.125, 2.5), cells, spacing);
  Mat3 L;
  L << 1.2, -0.5, 0.2, 0.5, -0.6, 0.1, 0.3, 0, -0.5;
  L = L.cast<float>().cast<Real>();
  Random random(4, 4);
  const Vec3 centre = Vec3(-3.25, 5.125, 2.5) + 0.5 * spacing * cells.cast<Real>();
  for (std::size_t p = 0; p < model.X.size(); ++p) {
    Vec3& x = model.X[p];
    x += 0.12 * Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
    x = (x * 0x1p18).array().round() * 0x1p-18;
    model.velocity[p] = (Vec3(3, -2, 1.5) + L * (x - centre)).cast<float>().cast<Real>();
    model.volume[p] = static_cast<float>(model.volume[p]);
  }
  model.velocity_gradient[0] = L;
  return model;
}

void append(Model& model, const LatticeModel& other) {
  const auto first_body = static_cast<std::uint16_t>(model.velocity_gradient.size());
  const auto put = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  put(model.X, other.model.X);
  put(model.volume, other.model.volume);
  put(model.velocity, other.model.velocity);
  put(model.velocity_gradient, other.model.velocity_gradient);
  put(model.material, other.model.material);
  put(model.crease, other.model.crease);
  put(model.spacing, other.model.spacing);
  for (const std::uint16_t body : other.model.body)
    model.body.push_back(static_cast<std::uint16_t>(body + first_body));
}

Vec3 momentum_scale(const FrameReport& r) { return Vec3::Constant(r.mass * r.max_speed); }

}  // namespace

TEST_CASE("tile mesh: elements and vertices follow the reference for 100 steps") {
  struct Case {
    const char* surface;
    Real tau_c, softening;
    Real tolerance;  // softening localises, which magnifies any round-off
    Transfer transfer = Transfer::apic;
  };
  for (const Case& c :
       {Case{"elastic", 1, 0, 5e-6}, Case{"von_mises", 8, 3, 5e-6}, Case{"rankine", 8, 0, 5e-6},
        Case{"rankine", 8, 5, 1e-5}, Case{"von_mises", 8, 3, 5e-6, Transfer::flip}}) {
    SceneDesc scene = float_mesh_scene();
    scene.solver.transfer = c.transfer;
    scene.materials[0] = with_surface(scene.materials[0], c.surface, c.tau_c, c.softening);
    const Model model = drawn_bar(Vec3i(12, 8, 9), 0.75);
    ReferenceSolver reference(scene, model);
    const FrameReport truth = reference.advance(1.0);
    REQUIRE(truth.substeps == 100);
    std::vector<Mat3> strain;
    const MeshElements mesh(scene, model);
    Real largest = 0;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      const Mat3 F = element_edges(mesh.elements[e].corner, reference.particles().x) *
                     mesh.elements[e].rest_inverse * reference.mesh_state().plastic_inverse[e];
      strain.push_back(F * F.transpose() - Mat3::Identity());
      largest = std::max(largest, strain.back().cwiseAbs().maxCoeff());
    }
    for (const TileKernels* kernels : all_tile_kernels()) {
      CAPTURE(c.surface);
      CAPTURE(kernels->name);
      TileSolver tile(scene, model, kernels);
      const FrameReport report = tile.advance(1.0);
      REQUIRE(report.status == Status::ok);
      CHECK(report.substeps == 100);
      CHECK(tile.times().rebins >= 3);
      const std::vector<TileSolver::Point> points = tile.points();
      const std::vector<TileMesh::Element> elements = tile.mesh().elements();
      Real x = 0, v = 0, v_max = 0, e_strain = 0, e_tau_c = 0;
      for (std::size_t p = 0; p < points.size(); ++p) {
        x = std::max(x, (points[p].x - reference.particles().x[p]).cwiseAbs().maxCoeff());
        v = std::max(v, (points[p].v - reference.particles().v[p]).cwiseAbs().maxCoeff());
        v_max = std::max(v_max, reference.particles().v[p].cwiseAbs().maxCoeff());
      }
      for (std::size_t e = 0; e < elements.size(); ++e) {
        e_strain =
            std::max(e_strain, (elements[e].elastic_strain - strain[e]).cwiseAbs().maxCoeff());
        e_tau_c = std::max(e_tau_c, std::abs(elements[e].tau_c - reference.mesh_state().tau_c[e]));
      }
      MESSAGE(std::string(kernels->name), " ", std::string(c.surface), ": x ", x, " cells, v ",
              v / v_max, ", strain ", e_strain / largest, ", tau_c ", e_tau_c / c.tau_c);
      CHECK(x <= 5e-6);
      CHECK(v <= 1e-6 * v_max);
      CHECK(e_strain <= c.tolerance * largest);
      CHECK(e_tau_c <= 4 * c.tolerance * c.tau_c);
      CHECK(report.yielded == truth.yielded);
      CHECK(report.elastic_energy == doctest::Approx(truth.elastic_energy).epsilon(1e-5));
      CHECK(report.dissipated_energy == doctest::Approx(truth.dissipated_energy).epsilon(1e-4));
      CHECK((report.momentum - truth.momentum).norm() <= 1e-7 * momentum_scale(truth).norm());
      const Snapshot a = tile.snapshot(), b = reference.snapshot();
      Real stress = 0, most = 0;
      for (std::size_t p = 0; p < a.x.size(); ++p) {
        stress = std::max<Real>(stress, std::abs(a.stress[p] - b.stress[p]));
        most = std::max<Real>(most, std::abs(b.stress[p]));
      }
      CHECK(stress <= 2.5e-4 * most);
    }
  }
}

TEST_CASE("tile mesh: a free body keeps its momenta") {
  SceneDesc scene = float_mesh_scene();
  const Model model = drawn_bar(Vec3i(6, 4, 4), 0.75);
  TileSolver solver(scene, model);
  const FrameReport before = solver.snapshot().report;
  const FrameReport after = solver.advance(3);
  REQUIRE(after.status == Status::ok);
  CHECK(after.elastic_energy > 0);
  CHECK((after.momentum - before.momentum).norm() <= 1e-6 * before.momentum.norm());
  CHECK((after.angular_momentum - before.angular_momentum).norm() <=
        2e-6 * before.angular_momentum.norm());
}

TEST_CASE("tile mesh: any number of threads and AVX2 or AVX-512 give the same bits") {
  SceneDesc scene = float_mesh_scene();
  scene.materials[0] = with_surface(scene.materials[0], "rankine", 8, 20);
  scene.materials[0].damage.type = DamageType::granular;
  const Model model = drawn_bar(Vec3i(12, 6, 6), 0.75);
  test::check_same_bits([&](const TileKernels* kernels, int) {
    TileSolver solver(scene, model, kernels);
    const FrameReport r = solver.advance(1.0);
    REQUIRE(r.status == Status::ok);
    CHECK(r.damaged > 0);
    return r.state_hash;
  });
}

TEST_CASE("tile mesh: rubble, particles beside elements and a floor follow the reference") {
  SceneDesc scene = float_mesh_scene();
  scene.gravity = Vec3(0, -1, 0);
  scene.materials[0] = with_surface(scene.materials[0], "rankine", 8, 20);
  scene.materials[0].damage.type = DamageType::granular;
  MaterialDesc heavy = with_surface(plain_scene().materials[0], "von_mises", 5, 2);
  heavy.density = 3;
  scene.materials.push_back(heavy);
  scene.bodies.push_back({});
  ColliderDesc floor;
  floor.shape = PlaneDesc{Vec3(0, 1, 0)};
  floor.contact = Contact::separate;
  floor.motion.push_back({});
  scene.colliders.push_back(floor);
  Model model = kuhn_box(Vec3(-2, 0.3, -2), Vec3i(6, 5, 6), 0.7);
  for (Vec3& v : model.velocity) v = Vec3(1, -9, 0.5);
  for (std::size_t p = 0; p < model.X.size(); ++p) model.strength.push_back(p % 3 ? 1.0f : 1.5f);
  LatticeModel ball;
  ball.add_box(Vec3(-1, 4.2, -1), Vec3i(5, 4, 5), 0.5, Vec3(0, -8, 0), 0.2, 1);
  append(model, ball);
  model.strength.resize(model.X.size(), 1.0f);
  TileSolver tile(scene, model);
  ReferenceSolver reference(scene, model);
  Index damaged = 0;
  for (int frame = 0; frame < 4; ++frame) {
    const FrameReport t = tile.advance(0.2), r = reference.advance(0.2);
    REQUIRE(t.status == Status::ok);
    damaged = r.damaged;
    CHECK(t.substeps == r.substeps);
    const Real grown = std::pow(10.0, frame);
    CHECK(std::abs(t.damaged - r.damaged) <= 1 + frame);
    CHECK(std::abs(t.yielded - r.yielded) <= 1 + frame);
    CHECK((t.momentum - r.momentum).norm() <= 1e-5 * grown * r.mass * r.max_speed);
    CHECK(t.kinetic_energy == doctest::Approx(r.kinetic_energy).epsilon(1e-4 * grown));
    CHECK(t.elastic_energy == doctest::Approx(r.elastic_energy).epsilon(1e-3 * grown));
    CHECK(t.dissipated_energy == doctest::Approx(r.dissipated_energy).epsilon(1e-3 * grown));
  }
  CHECK(damaged > 5);
}

TEST_CASE("tile mesh: flat and inverted elements open again as in the reference") {
  SceneDesc scene = float_mesh_scene();
  scene.solver.time_step = 0.002;
  const Model rest = kuhn_box(Vec3(0, 0, 0), Vec3i(1, 1, 1), 1);
  for (const Real speed : {8.0, 200.0}) {
    Model model = rest;
    for (std::size_t p = 0; p < model.X.size(); ++p)
      model.velocity[p] = Vec3(-speed * (model.X[p][0] - 0.5), 0.1 * speed * model.X[p][1], 0);
    scene.materials[0].youngs_modulus = 20;
    TileSolver tile(scene, model);
    ReferenceSolver reference(scene, model);
    Index clamped = 0;
    for (int frame = 0; frame < 5; ++frame) {
      const FrameReport t = tile.advance(0.1), r = reference.advance(0.1);
      REQUIRE(t.status == Status::ok);
      CHECK(t.clamped == r.clamped);
      clamped += r.clamped;
      CHECK(t.elastic_energy == doctest::Approx(r.elastic_energy).epsilon(1e-3));
    }
    CHECK((clamped > 0) == (speed > 20));
  }
}

TEST_CASE("tile mesh: state files, and materials that change mid-run") {
  SceneDesc scene = float_mesh_scene();
  scene.materials[0] = with_surface(scene.materials[0], "von_mises", 5, 3);
  const Model model = drawn_bar(Vec3i(6, 4, 4), 0.75);
  TileSolver a(scene, model);
  CHECK(a.advance(0.4).yielded > 0);
  std::stringstream file;
  a.save(file);
  TileSolver b(scene, model);
  b.load(file);
  CHECK(b.snapshot().report.elastic_energy == a.snapshot().report.elastic_energy);
  CHECK(b.advance(0.4).state_hash == a.advance(0.4).state_hash);

  ReferenceSolver reference(scene, model);
  TileSolver tile(scene, model);
  MaterialDesc soft = scene.materials[0];
  soft.yield_surface.value[0] = 2.5;
  soft.density = 2;
  for (Solver* solver : {static_cast<Solver*>(&tile), static_cast<Solver*>(&reference)}) {
    solver->advance(0.2);
    solver->set_material(0, soft);
  }
  const FrameReport t = tile.advance(0.3), r = reference.advance(0.3);
  CHECK(t.elastic_energy == doctest::Approx(r.elastic_energy).epsilon(1e-4));
  CHECK(t.kinetic_energy == doctest::Approx(r.kinetic_energy).epsilon(1e-5));
  CHECK(t.yielded == r.yielded);
}
