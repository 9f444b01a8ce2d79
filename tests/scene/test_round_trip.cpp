// Random scenes with every variant survive write_scene and parse_scene to the last bit.
#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/core/random.h"
#include "engine/scene/scene_reader.h"

namespace rend {

namespace {

namespace fs = std::filesystem;

/// Draws scenes whose numbers use all 53 bits and stay inside every allowed range.
class SceneDraw {
 public:
  explicit SceneDraw(std::uint64_t seed) : random_(seed, 7) {}

  SceneDesc scene() {
    SceneDesc s;
    s.name = "scene \"\\/\n\xc3\xa9 " + std::to_string(count(1000));
    s.description = flip() ? "" : "text";
    s.frame_rate = number(20, 30);
    s.frames = 1 + count(1000);
    s.seed = static_cast<std::uint64_t>(random_.next(0, 9e15));
    s.gravity = vector(10);
    s.grid.dx = number(0.01, 0.1);
    s.solver = solver();
    for (int i = 0; i <= count(3); ++i) s.materials.push_back(material(i));
    for (int i = 0; i <= count(4); ++i) s.bodies.push_back(body(s));
    for (int i = 0; i < count(5); ++i) s.colliders.push_back(collider());
    s.fracture.break_test = pick<BreakTest>(2);
    if (flip()) s.fracture.stretch = number(1.1, 3);
    s.fracture.gap = number(0.1, 2);
    s.fracture.smoothing_iterations = count(20);
    s.fracture.smallest_fragment = 1 + count(20);
    s.camera = {vector(1) + Vec3(5, 0, 0), vector(1), number(10, 90)};
    s.render.color_by = flip() ? "stress" : "none";
    s.render.particles = flip();
    if (flip()) s.render.floor = number(-5, 5);
    return s;
  }

 private:
  Real number(Real low, Real high) { return random_.next(low, high); }
  int count(int limit) { return static_cast<int>(random_.next(0, limit)); }
  bool flip() { return random_.next() < 0.5; }
  Vec3 vector(Real size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  template <class E>
  E pick(int values) {
    return static_cast<E>(count(values));
  }

  SolverDesc solver() {
    SolverDesc s;
    s.precision = pick<Precision>(2);
    s.transfer = pick<Transfer>(6);
    s.kernel = pick<Kernel>(2);
    s.force_form = pick<ForceForm>(2);
    s.deformation_update = pick<DeformationUpdate>(2);
    s.flip_ratio = number(0, 1);
    s.rpic_blend = number(0, 1);
    s.polypic_modes = flip() ? 4 : 1;
    s.xpic_order = 1 + count(5);
    s.cfl = number(0.1, 1);
    s.time_step = flip() ? number(1e-5, 1e-3) : 0;
    return s;
  }

  MaterialDesc material(int index) {
    MaterialDesc m;
    m.name = "m/~ " + std::to_string(index);
    m.density = number(500, 2000);
    m.youngs_modulus = number(1e4, 1e6);
    m.poisson_ratio = number(0, 0.4999);
    m.yield_surface.type = count(yield_surface_count());
    const auto parameters = yield_surface_parameters(m.yield_surface.type);
    for (std::size_t i = 0; i < parameters.size(); ++i)
      m.yield_surface.value[i] = std::clamp(number(0, 1e4), parameters[i].min, parameters[i].max);
    if (find_parameter(m.yield_surface.type, "softening"))
      m.softening_rule = pick<SofteningRule>(2);
    m.damage = {pick<DamageType>(3), number(0, 1), number(0, 1), number(0, 80)};
    if (flip()) m.strength_field = {number(1, 50), number(0.01, 1)};
    return m;
  }

  ShapeDesc shape() {
    switch (count(6)) {
      case 0:
        return BoxDesc{vector(0.4) + Vec3::Ones()};
      case 1:
        return SphereDesc{number(0.1, 1)};
      case 2:
        return CylinderDesc{number(0.1, 1), number(0.1, 1)};
      case 3:
        return TorusDesc{number(0.5, 1), number(0.1, 0.4)};
      case 4:
        return PrismDesc{{{0, 0}, {number(1, 2), 0}, {number(1, 2), number(1, 2)}, {-0.0, 1}},
                         number(0.1, 1)};
      default:
        return MeshDesc{"round_trip.obj", "", number(0.1, 2)};
    }
  }

  BodyDesc body(const SceneDesc& scene) {
    BodyDesc b;
    b.shape = shape();
    b.material = static_cast<std::size_t>(count(static_cast<int>(scene.materials.size())));
    b.force = pick<ForceKind>(2);
    b.particles_per_cell = number(1, 20);
    b.sampling = pick<Sampling>(3);
    b.position = vector(3);
    b.rotation = vector(180);
    b.velocity = vector(3);
    b.velocity_gradient.row(count(3)) = vector(2);
    return b;
  }

  ColliderDesc collider() {
    ColliderDesc c;
    switch (count(4)) {
      case 0:
        c.shape = PlaneDesc{vector(1) + Vec3(0, 3, 0)};
        break;
      case 1:
        c.shape = BoxDesc{vector(0.4) + Vec3::Ones()};
        break;
      case 2:
        c.shape = SphereDesc{number(0.1, 1)};
        break;
      default:
        c.shape = CylinderDesc{number(0.1, 1), number(0.1, 1)};
    }
    c.contact = pick<Contact>(3);
    c.friction = number(0, 1);
    for (int k = 0; k <= count(4); ++k)
      c.motion.push_back({k + number(0, 0.9), vector(2), vector(90)});
    if (flip()) c.release_time = number(0, 3);
    c.visible = flip();
    return c;
  }

  Random random_;
};

/// Gives meshes the path that the reader will find.
void resolve_meshes(SceneDesc& scene, const fs::path& folder) {
  for (BodyDesc& body : scene.bodies)
    if (auto* mesh = std::get_if<MeshDesc>(&body.shape))
      mesh->path = (folder / mesh->file).string();
}

}  // namespace

TEST_CASE("random scenes read back equal") {
  const fs::path folder = fs::temp_directory_path() / "rend_round_trip";
  fs::create_directories(folder);
  std::ofstream(folder / "round_trip.obj") << "v 0 0 0\n";
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    CAPTURE(seed);
    SceneDesc scene = SceneDraw(seed).scene();
    resolve_meshes(scene, folder);
    const std::string text = write_scene(scene);
    const SceneDesc again = parse_scene(text, "round trip", folder);
    REQUIRE(again == scene);
    REQUIRE(write_scene(again) == text);
  }
  fs::remove_all(folder);
}

TEST_CASE("a scene whose softening comes from its fracture energy reads back equal") {
  SceneDesc scene = SceneDraw(1).scene();
  MaterialDesc& m = scene.materials[0];
  m.yield_surface.type = find_yield_surface("rankine").value();
  m.yield_surface.value = {1e3, 0};
  m.fracture_energy = 0.1 + 1e3;
  scene.bodies = {BodyDesc{}};
  const SceneDesc once = parse_scene(write_scene(scene), "once", ".");
  CHECK(once.materials[0].yield_surface.value[1] > 0);
  CHECK(parse_scene(write_scene(once), "twice", ".") == once);
}

TEST_CASE("equality sees a change of any number") {
  const SceneDesc scene = SceneDraw(3).scene();
  SceneDesc other = scene;
  other.bodies[0].velocity_gradient(1, 2) =
      std::nextafter(scene.bodies[0].velocity_gradient(1, 2), 1);
  CHECK_FALSE(other == scene);
  other = scene;
  other.materials[0].strength_field.length += 1;
  CHECK_FALSE(other == scene);
}

TEST_CASE("hard doubles are written so that they read back to the same bits") {
  for (const Real value :
       {0.1, -0.0, 1e-320, 5e-324, 123456789012345680.0, 2. / 3, 1e22, -1e-7, 9999.999999999998}) {
    SceneDesc scene = SceneDraw(2).scene();
    scene.bodies = {BodyDesc{}};
    scene.gravity.x() = std::clamp(value, -1e5, 1e5);
    const Real read = parse_scene(write_scene(scene), "bits", ".").gravity.x();
    CHECK(std::memcmp(&read, &scene.gravity.x(), sizeof read) == 0);
  }
}

TEST_CASE("written scenes are JSON for any reader, with the keys in the order of the tables") {
  const SceneDesc scene = SceneDraw(4).scene();
  const auto json = nlohmann::ordered_json::parse(write_scene(scene));
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  CHECK(keys == std::vector<std::string>{"name", "description", "frame_rate", "frames", "seed",
                                         "gravity", "grid", "solver", "materials", "bodies",
                                         "colliders", "fracture", "camera", "render"});
  CHECK(json["name"].get<std::string>() == scene.name);
  CHECK(json["camera"]["eye"][1].get<double>() == scene.camera.eye.y());
}

}  // namespace rend
