// Scene files that are right: defaults, shorthands, overrides, crack band, round trips, the scenes
// of the repository.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "engine/core/error.h"
#include "engine/scene/scene_reader.h"

namespace rend {

namespace {

namespace fs = std::filesystem;

const std::string kSmall = R"({
  "grid": {"dx": 0.05},
  "materials": {"clay": {"density": 1000, "youngs_modulus": 1e5, "poisson_ratio": 0.3,
    "yield_surface": {"type": "rankine", "tau_c": 1e4}}},
  "bodies": [{"shape": {"type": "box", "size": [1, 0.2, 0.2]}, "material": "clay"}]
})";

const MeshFolders kModels{fs::path(REND_SOURCE_DIR) / "build"};

SceneDesc parse(const std::string& text, const Overrides& overrides = {}) {
  return parse_scene(text, "test.json", ".", {}, overrides);
}

Real yield_value(const MaterialDesc& material, const char* name) {
  return material.yield_surface.value[find_parameter(material.yield_surface.type, name).value()];
}

}  // namespace

TEST_CASE("what a scene leaves out keeps the defaults of SceneDesc") {
  const SceneDesc scene = parse(kSmall);
  const SceneDesc plain;
  CHECK(scene.solver == plain.solver);
  CHECK(scene.fracture == plain.fracture);
  CHECK(scene.camera == plain.camera);
  CHECK(scene.render == plain.render);
  CHECK(scene.frames == plain.frames);
  CHECK(scene.gravity == plain.gravity);
  REQUIRE(scene.materials.size() == 1);
  CHECK(scene.materials[0].name == "clay");
  CHECK(scene.materials[0].damage == DamageDesc{});
  CHECK(yield_value(scene.materials[0], "tau_c") == 1e4);
  CHECK(yield_value(scene.materials[0], "softening") == 0);
  REQUIRE(scene.bodies.size() == 1);
  CHECK(std::get<BoxDesc>(scene.bodies[0].shape).size == Vec3(1, 0.2, 0.2));
  CHECK(scene.colliders.empty());
}

TEST_CASE("a resting collider may be written without keyframes") {
  const SceneDesc scene = parse(kSmall, {{"/colliders", R"([
    {"shape": {"type": "plane", "normal": [0, 2, 0]}, "position": [0, -1, 0], "rotation": [0, 90, 0]},
    {"shape": {"type": "sphere", "radius": 1}},
    {"shape": {"type": "cylinder", "radius": 1, "height": 2}, "release_time": 2.5,
     "motion": [{"time": 1}, {"time": 2, "position": [1, 0, 0]}]}])"}});
  REQUIRE(scene.colliders.size() == 3);
  CHECK(scene.colliders[0].motion == std::vector<Keyframe>{{0, Vec3(0, -1, 0), Vec3(0, 90, 0)}});
  CHECK(scene.colliders[1].motion == std::vector<Keyframe>{Keyframe{}});
  CHECK(scene.colliders[1].release_time < 0);
  CHECK(scene.colliders[2].motion.size() == 2);
  CHECK(scene.colliders[2].release_time == 2.5);
}

TEST_CASE("overrides replace, create and remove before the checks") {
  const SceneDesc scene = parse(kSmall, {{"/grid/dx", "0.02"},
                                         {"/solver/transfer", "flip"},  // no JSON: taken as text
                                         {"/solver/precision", "\"double\""},
                                         {"/bodies/0/shape/size/1", "0.5"},
                                         {"/materials/clay/yield_surface/softening", "2e4"},
                                         {"/description", "7 bars"}});
  CHECK(scene.grid.dx == 0.02);
  CHECK(scene.solver.transfer == Transfer::flip);
  CHECK(scene.solver.precision == Precision::float64);
  CHECK(std::get<BoxDesc>(scene.bodies[0].shape).size == Vec3(1, 0.5, 0.2));
  CHECK(yield_value(scene.materials[0], "softening") == 2e4);
  CHECK(scene.description == "7 bars");

  const SceneDesc energy =
      parse(kSmall, {{"/materials/clay/yield_surface/softening", "2e4"},
                     {"/materials/clay/yield_surface/softening", "null"},
                     {"/materials/clay/yield_surface/fracture_energy", "200"}});
  CHECK(energy.materials[0].fracture_energy == 200);

  Overrides slash{
      {"/materials", R"({"a/b~c": {"density": 1, "youngs_modulus": 1, "poisson_ratio": 0}})"},
      {"/bodies/0/material", "a/b~c"},
      {"/materials/a~1b~0c/density", "7"}};
  CHECK(parse(kSmall, slash).materials[0].density == 7);
}

TEST_CASE("fracture energy sets softening from the width of the crack band") {
  const auto softening = [](const Overrides& more) {
    Overrides all{{"/materials/clay/yield_surface/fracture_energy", "200"}};
    all.insert(all.end(), more.begin(), more.end());
    return yield_value(parse(kSmall, all).materials[0], "softening");
  };
  // Half of tau_c times the opening: a crack is open at 0.04 m, dx is 0.05 m.
  const auto alpha = [](Real width) { return width * 1e4 * 1e4 / (2 * 200.0); };
  const Real shrunk = 0.05 * std::sqrt(0.05 / 0.04);
  CHECK(softening({}) == doctest::Approx(alpha(1.1 * shrunk)).epsilon(1e-14));
  CHECK(softening({{"/solver/kernel", "cubic"}}) ==
        doctest::Approx(alpha(1.7 * shrunk)).epsilon(1e-14));
  // Softening ends long before particles part: the whole band of the kernel.
  CHECK(softening({{"/grid/dx", "0.2"}}) == doctest::Approx(alpha(2.3 * 0.2)).epsilon(1e-14));
  const std::pair<std::string, std::string> mesh{"/bodies/0/force", "mesh"};
  CHECK(softening({mesh}) == doctest::Approx(alpha(2.5 * 0.05)).epsilon(1e-14));
  CHECK(softening({mesh, {"/bodies/0/particles_per_cell", "2"}}) == softening({mesh}));
  CHECK(softening({mesh, {"/grid/dx", "0.025"}}) ==
        doctest::Approx(alpha(1.25 * 0.05)).epsilon(1e-14));
}

TEST_CASE("the largest dx that a snap-back message names is the limit") {
  const Overrides energy{{"/materials/clay/yield_surface/fracture_energy", "20"}};
  // Rankine in tension snaps back at alpha = 2 mu + lambda = E (1 - nu) / ((1 + nu) (1 - 2 nu)).
  const Real modulus = 1e5 * 0.7 / (1.3 * 0.4);
  const Real largest = 2 * 20 * modulus / (2.3 * 1e8);
  const auto at_dx = [&](Real dx) {
    return parse(kSmall, {energy[0], {"/grid/dx", std::to_string(dx)}});
  };
  CHECK_NOTHROW(at_dx(largest * 0.999));
  try {
    at_dx(largest * 1.001);
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.where() == "test.json#/materials/clay/yield_surface/fracture_energy");
    const std::string named = "take dx below ";
    const auto at = error.why().find(named);
    REQUIRE(at != std::string::npos);
    CHECK(std::stod(error.why().substr(at + named.size())) ==
          doctest::Approx(largest).epsilon(1e-3));
  }
}

TEST_CASE("a clockwise outline is turned round") {
  const SceneDesc scene = parse(
      kSmall, {{"/bodies/0/shape",
                R"({"type": "prism", "outline": [[0, 0], [0, 1], [1, 1], [1, 0]], "depth": 1})"}});
  const auto& outline = std::get<PrismDesc>(scene.bodies[0].shape).outline;
  Real area = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto &a = outline[i], &b = outline[(i + 1) % 4];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  CHECK(area == 1);
}

TEST_CASE("every scene of the repository parses and survives a round trip") {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(REND_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() != ".json" || entry.path().filename() == "schema.json") continue;
    CAPTURE(entry.path());
    ++count;
    SceneDesc scene;
    try {
      scene = read_scene(entry.path(), kModels);
    } catch (const Error& error) {
      // Without the set-up step a mesh may be missing; that and nothing else is allowed here.
      REQUIRE(error.why().find("cannot find the mesh") != std::string::npos);
      REQUIRE_FALSE(fs::exists(kModels[0] / "models" / ".unpacked"));
      MESSAGE("skipped: " << std::string(error.what()));
      continue;
    }
    CHECK(scene.name == entry.path().stem().string());
    const std::string written = write_scene(scene);
    const SceneDesc again = parse_scene(written, "again", entry.path().parent_path(), kModels);
    CHECK(again == scene);
    CHECK(write_scene(again) == written);
  }
  CHECK(count >= 3);
}

}  // namespace rend
