// Every scene of scenes/ reads, has as many particles as its experiment, and runs its first frames.
#include "app/pipeline.h"
#include "app/scene_library.h"
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/fracture/check_mesh.h"
#include "tests/effort.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

using namespace rend;

namespace {

constexpr double kMemoryLimit = 8e9;  // bytes
constexpr double kQuickParticles = 20000;
constexpr double kQuickMeshParticles = 1500;  // mesh forces run in the reference solver

/// Particle counts that the slides of 2019 give, by the beginning of the scene's name.
const std::map<std::string, double> kExperiments = {
    {"e1_", 77e3},  {"e2_", 60e3}, {"e3_", 60e3}, {"e4_", 207e3},    {"e5_", 200e3},   {"e6_", 4e3},
    {"e7_", 130e3}, {"e8_", 60e3}, {"e10_", 8e3}, {"e11_60k", 60e3}, {"e11_17k", 17e3}};

bool uses_mesh_file(const SceneDesc& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const BodyDesc& body) {
    return std::holds_alternative<MeshDesc>(body.shape);
  });
}

/// False, with a message, when the scene needs a mesh file that is not installed.
bool can_be_built(const std::string& name, const SceneDesc& scene) {
  try {
    estimate_model(scene);
    return true;
  } catch (const Error& error) {
    if (!uses_mesh_file(scene)) throw;
    MESSAGE(name << " is skipped: " << std::string(error.what()));
    return false;
  }
}

/// The scene on a grid so coarse that two frames take about a second; REND_FULL=1 runs it as it is,
/// to its end.
SceneDesc quick(const SceneLibrary& library, const std::string& name, const SceneDesc& scene) {
  const bool mesh_forces =
      std::any_of(scene.bodies.begin(), scene.bodies.end(),
                  [](const BodyDesc& body) { return body.force == ForceKind::mesh; });
  const double wanted = mesh_forces ? kQuickMeshParticles : kQuickParticles;
  const double particles = estimate_model(scene).particles;
  if (particles < wanted) return scene;
  return library.read(
      name, {{"/grid/dx", std::to_string(scene.grid.dx * std::cbrt(particles / wanted))}});
}

/// Volume that the surface encloses at rest.
Real rest_volume(const SurfaceMesh& surface) {
  SurfaceMesh at_rest = surface;
  at_rest.x = surface.rest;
  return enclosed_volume(at_rest);
}

/// Its first frames, or with REND_FULL=1 all of them, have closed surfaces of the same matter.
void run_frames(const SceneDesc& scene) {
  Pipeline pipeline(scene, std::make_shared<Model>(build_model(scene, kMemoryLimit)));
  const Real volume = rest_volume(*pipeline.current().surface);
  const int frames = test::by_effort(1, 2, scene.frames);
  for (int n = 1; n <= frames; ++n) {
    const Frame frame = pipeline.advance();
    CAPTURE(n);
    CAPTURE(frame.snapshot->report.reason);
    REQUIRE(frame.snapshot->report.status == Status::ok);
    CHECK(frame.snapshot->frame == n);
    CHECK(frame.surface->triangle_count() > 100);
    MeshCheck check = check_mesh(*frame.surface);
    CAPTURE(check.text());
    // Squeezed matter may turn small pieces inside out; that is no fault of the topology.
    check.inside_out = 0;
    CHECK(check.good());
    CHECK(rest_volume(*frame.surface) == doctest::Approx(volume).epsilon(1e-12));
    CHECK(frame.snapshot->report.mass > 0);
    CHECK(std::all_of(frame.snapshot->x.begin(), frame.snapshot->x.end(),
                      [](const Vec3& x) { return x.allFinite(); }));
  }
}

}  // namespace

TEST_CASE("each experiment of the slides has its particle count within 5 %") {
  const SceneLibrary library(REND_SOURCE_DIR);
  for (const auto& [prefix, particles] : kExperiments) {
    int found = 0;
    for (const std::string& name : library.names()) {
      if (!name.starts_with(prefix)) continue;
      CAPTURE(name);
      ++found;
      const SceneDesc scene = library.read(name);
      if (can_be_built(name, scene))
        CHECK(estimate_model(scene).particles == doctest::Approx(particles).epsilon(0.05));
    }
    CAPTURE(prefix);
    CHECK(found > 0);
  }
}

TEST_CASE("each scene is named like its file, says what it teaches, and runs its first frames") {
  const SceneLibrary library(REND_SOURCE_DIR);
  for (const std::string& name : library.names()) {
    SUBCASE(name.c_str()) {
      const SceneDesc full = library.read(name);
      CHECK(full.name == name);
      CHECK(full.description.size() > 20);
      if (can_be_built(name, full))
        run_frames(test::full_effort() ? full : quick(library, name, full));
    }
  }
}

TEST_CASE("torn matter whose step is too long stops in the same state for the same reason") {
  const SceneDesc scene =
      SceneLibrary(REND_SOURCE_DIR)
          .read("tear", {{"/grid/dx", "0.04"}, {"/frame_rate", "6"}, {"/solver/cfl", "2"}});
  const auto model = std::make_shared<Model>(build_model(scene, kMemoryLimit));
  FrameReport first;
  set_thread_count(4);
  for (int run = 0; run < test::by_effort(3, 8, 60); ++run) {
    const auto solver = make_solver(scene, *model);
    FrameReport r;
    do r = solver->advance(1 / scene.frame_rate);
    while (r.status == Status::ok && r.time < 5);
    CHECK(r.status == Status::too_fast);
    if (run == 0) first = r;
    CHECK(r.reason == first.reason);
    CHECK(r.state_hash == first.state_hash);
  }
  set_thread_count(0);
}

TEST_CASE(
    "a bar that is flattened by a wall flows and does not crack, with the default break test") {
  const SceneLibrary library(REND_SOURCE_DIR);
  const SceneDesc scene = library.read("taylor_bar", {{"/grid/dx", "0.00107"}});
  CHECK(scene.fracture.break_test == BreakTest::gap);
  Pipeline pipeline(scene, std::make_shared<Model>(build_model(scene, kMemoryLimit)));
  const std::vector<Vec3> rest = pipeline.current().snapshot->x;
  Frame last;
  for (int n = 1; n <= scene.frames; ++n) {
    last = pipeline.advance();
    REQUIRE(last.snapshot->report.status == Status::ok);
  }
  const auto top = [](const std::vector<Vec3>& x) {
    Real y = 0;
    for (const Vec3& p : x) y = std::max(y, p.y());
    return y;
  };
  CHECK(top(last.snapshot->x) < 0.75 * top(rest));
  CHECK(last.fracture.broken_edges == 0);
  CHECK(last.fracture.pieces == 1);
}
