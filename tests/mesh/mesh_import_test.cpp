// Mesh files through the loader process: good ones arrive, damaged ones are refused in time.
#include "engine/mesh/mesh_import.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/random.h"
#include "engine/mesh/build_model.h"
#include "engine/mesh/repair.h"
#include "tests/effort.h"
#include "tests/mesh/sample_files.h"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>

using namespace rend;

namespace {

MeshLoading quick(Real wall_seconds = 3) {
  MeshLoading loading;
  loading.wall_seconds = wall_seconds;
  loading.cpu_seconds = 2;
  return loading;
}

struct Outcome {
  bool refused = false;
  std::string why;
  Real seconds = 0;
};

Outcome attempt(const std::string& bytes, const std::string& name, const MeshLoading& loading) {
  const auto start = std::chrono::steady_clock::now();
  Outcome o;
  try {
    const TriangleSurface s = import_mesh_bytes(bytes, name, loading);
    std::vector<std::string> notes;
    repair_surface(s, notes);
  } catch (const Error& e) {
    o.refused = true;
    o.why = e.why();
    CHECK(e.where() == "file");
  }
  o.seconds = std::chrono::duration<Real>(std::chrono::steady_clock::now() - start).count();
  return o;
}

// The time that the input takes, not the one that a busy machine takes: slow attempts are repeated.
Outcome timed_attempt(const std::string& bytes, const std::string& name, const MeshLoading& loading,
                      Real limit) {
  Outcome o = attempt(bytes, name, loading);
  for (int again = 0; again < 4 && o.seconds > limit; ++again) o = attempt(bytes, name, loading);
  return o;
}

// Damages a file as a bad transfer or a careless edit would; `n` numbers the damage.
std::string damaged(std::string bytes, std::uint64_t n) {
  Random random(n, 5);
  const auto place = [&] { return std::size_t(random.next() * Real(bytes.size())); };
  switch (n % 3) {
    case 0:
      bytes.resize(place());
      break;
    case 1:
      for (int i = 0, flips = 1 + int(random.next() * 16); i < flips; ++i)
        bytes[place()] = char(random.next() * 256);
      break;
    default:
      for (int i = 0; i < 4; ++i) {
        const std::size_t at = bytes.find_first_of("0123456789", place());
        if (at != bytes.npos) bytes.insert(at, 1, char('0' + int(random.next() * 10)));
      }
  }
  return bytes;
}

}  // namespace

TEST_CASE("a cube arrives from every plain format") {
  const TriangleSurface cube = cube_surface(Vec3(1, 2, 3));
  const std::pair<std::string, std::string> files[] = {{"c.obj", as_obj(cube)},
                                                       {"c.STL", as_stl(cube)},
                                                       {"c.ply", as_ply(cube)},
                                                       {"c.off", as_off(cube)}};
  for (const auto& [name, bytes] : files) {
    CAPTURE(name);
    std::vector<std::string> notes;
    const TriangleSurface s = repair_surface(import_mesh_bytes(bytes, name), notes);
    CHECK(s.positions.size() == 8);
    CHECK(s.triangles.size() == 12);
    CHECK(enclosed_volume(s) == doctest::Approx(1));
    CHECK(bounds_of(s.positions).low.isApprox(Vec3(1, 2, 3)));
    CHECK(notes.empty());
  }
}

TEST_CASE("files that cannot be meshes are refused with a reason") {
  const auto why = [](const std::string& bytes, const std::string& name) {
    const Outcome o = timed_attempt(bytes, name, quick(), 4);
    CHECK(o.refused);
    CHECK(o.seconds < 4);
    return o.why;
  };
  CHECK(why("v 0 0 0", "a.fbx").find("allowed are obj, stl, ply") != std::string::npos);
  CHECK(why("", "a.obj") == "a.obj is empty");
  CHECK(why("x", "a.obj").find("a.obj cannot be read") == 0);
  CHECK(why("<html><body>404</body></html>", "a.ply").find("does not begin with \"ply\"") !=
        std::string::npos);
  CHECK(why(std::string(200000, '['), "a.gltf").find("no JSON object") != std::string::npos);
  CHECK(why("{\"a\":" + std::string(200000, '['), "a.gltf").find("a.gltf") == 0);
  CHECK(why("ply\nformat ascii 1.0\nelement vertex 4\n", "a.ply").find("a.ply") == 0);
  CHECK(why("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
            "property float y\nproperty float z\nelement face 1\nproperty list uchar int "
            "vertex_indices\n"
            "end_header\n0123",
            "a.ply")
            .find("a.ply") == 0);
  CHECK(why("v 0 0 0\nv nan 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n", "a.obj")
            .find("coordinates must be numbers") != std::string::npos);
  CHECK(why("v 0 0 0\nv 1e30 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n", "a.obj")
            .find("coordinates must be numbers") != std::string::npos);
}

TEST_CASE("an OBJ with a foreign material library is read without it") {
  const std::string obj =
      "mtllib ../../../../etc/passwd\nmtllib /dev/zero\nusemtl root\n" + as_obj(cube_surface());
  const Outcome o = timed_attempt(obj, "a.obj", quick(), 4);
  CHECK_FALSE(o.refused);
  CHECK(o.seconds < 4);
}

TEST_CASE("a glTF file that needs other files is refused with advice") {
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,)"
      R"("componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("buffers":[{"uri":"/etc/passwd","byteLength":36}]})";
  CHECK(attempt(gltf, "a.gltf", quick()).why.find("must be complete in one file") !=
        std::string::npos);
}

TEST_CASE("a loader that is missing, hangs or dies is told apart and leaves no process") {
  MeshLoading loading = quick(0.3);
  loading.loader = "/nowhere/rend-meshload";
  const std::string obj = as_obj(cube_surface());
  CHECK(attempt(obj, "a.obj", loading).why.find("cannot start the mesh loader") !=
        std::string::npos);
  const auto script =
      std::filesystem::temp_directory_path() / ("rend_test_loader_" + std::to_string(getpid()));
  const auto with = [&](const std::string& body) {
    std::ofstream(script) << "#!/bin/sh\n" << body << "\n";
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
    loading.loader = script;
    return timed_attempt(obj, "a.obj", loading, 1.3);
  };
  const Outcome hang = with("exec sleep 60");
  CHECK(hang.why.find("did not finish in 0.3 s") != std::string::npos);
  CHECK(hang.seconds < 1.3);
  const Outcome closed = with("exec >&-; exec sleep 60");
  CHECK(closed.why.find("did not finish") != std::string::npos);
  CHECK(closed.seconds < 1.3);
  CHECK(with("kill -KILL $$").why.find("killed from outside") != std::string::npos);
  CHECK(with("kill -SEGV $$").why.find("crashed on it (signal 11)") != std::string::npos);
  CHECK(with("echo nonsense that is long enough to be a header").why.find("nonsense") !=
        std::string::npos);
  CHECK(with("exit 0").why.find("gave up") != std::string::npos);
  std::filesystem::remove(script);
  CHECK(waitpid(-1, nullptr, WNOHANG) == -1);
}

TEST_CASE("damaged files never harm the program and never take longer than the limit") {
  const TriangleSurface cube = merged(cube_surface(), cube_surface(Vec3(3, 0, 0)));
  const std::pair<std::string, std::string> files[] = {{"c.obj", as_obj(cube)},
                                                       {"c.stl", as_stl(cube)},
                                                       {"c.ply", as_ply(cube)},
                                                       {"c.off", as_off(cube)}};
  const Index count = test::by_effort(100, 200, 1000);
  const Real wall = 0.5;
  std::atomic<int> refused = 0, slow = 0;
  parallel_chunks(2, 1, [&](Index begin, Index) {
    for (Index n = begin; n < count; n += 2) {
      const auto& [name, bytes] = files[std::size_t(n / 2 % 4)];
      const Outcome o =
          timed_attempt(damaged(bytes, std::uint64_t(n)), name, quick(wall), wall + 1);
      refused += o.refused;
      slow += o.seconds > wall + 1;
    }
  });
  CHECK(slow == 0);
  CHECK(refused > count / 10);
  CHECK(refused < count);
}

TEST_CASE("a mesh file becomes a body of the given height") {
  const auto file = std::filesystem::temp_directory_path() / "rend_test_block.obj";
  std::ofstream(file) << as_obj(cube_surface(Vec3(5, 5, 5), 3));
  SceneDesc scene;
  scene.grid.dx = 0.2;
  scene.materials.resize(1);
  scene.bodies.resize(1);
  scene.bodies[0].shape = MeshDesc{"block.obj", file.string(), 2.0};
  scene.bodies[0].position = Vec3(0, 1, 0);
  const Model m = build_model(scene);
  const Bounds b = bounds_of(m.X);
  CHECK((b.low - Vec3(-1, 0, -1)).norm() < 1e-6);
  CHECK((b.high - Vec3(1, 2, 1)).norm() < 1e-6);
  CHECK(std::abs(Real(m.X.size()) / 8000 - 1) < 0.05);
  CHECK(m.notes.empty());
  // The same block as an exact box: sharp edges were found again.
  const auto creases = std::count(m.crease.begin(), m.crease.end(), 1);
  CHECK(creases > 12 * 18);
  CHECK(creases < 12 * 26);
  std::filesystem::remove(file);
  try {
    build_model(scene);
    FAIL("no error");
  } catch (const Error& e) {
    CHECK(e.where() == "/bodies/0/shape/file");
  }
}
