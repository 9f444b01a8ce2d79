// Mesh files from viewers: the scene that is made of them, refusals, and what is left on the disk.
#include "app/api_upload.h"
#include "engine/core/error.h"
#include "engine/mesh/build_model.h"
#include "tests/app/program.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

using namespace rend;

namespace {

/// A box of this size as OBJ text; without its last faces when `open`.
std::string box_obj(const Vec3& size, bool open = false) {
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += fmt::format("v {} {} {}\n", (i & 1) * size.x(), (i >> 1 & 1) * size.y(),
                        (i >> 2 & 1) * size.z());
  const char* faces = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\n";
  return text + faces + (open ? "" : "f 1 5 7 3\nf 2 4 8 6\n");
}

struct Place {
  test::TemporaryFolder folder;
  SceneLibrary library{folder.path()};
  MeshLoading loading;
  Place() {
    std::filesystem::create_directory(folder.path() / "scenes");
    loading.loader = std::filesystem::path(REND_BINARY).parent_path() / "rend-meshload";
  }
};

std::string why(MeshUploads& uploads, const std::string& name, const std::string& bytes) {
  try {
    uploads.add(name, bytes);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("upload: a mesh becomes a scene that is pulled along its longest axis") {
  Place place;
  MeshUploads uploads(place.library, place.loading);
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    Vec3 size(20, 20, 20);
    size[axis] = 80;
    const UploadedMesh mesh = uploads.add(fmt::format("my bar {}.OBJ", axis), box_obj(size));
    CHECK(mesh.name == fmt::format("my_bar_{}", axis));
    const SceneDesc scene = place.library.read(mesh.name);
    const ModelEstimate estimate = estimate_model(scene, place.loading);
    CHECK(estimate.particles > 15000);
    CHECK(estimate.particles < 40000);
    REQUIRE(scene.colliders.size() == 3);
    for (int side : {0, 1}) {
      const auto& motion = scene.colliders[static_cast<std::size_t>(side)].motion;
      const Vec3 way = motion.back().position - motion.front().position;
      CHECK(way[axis] == doctest::Approx(side == 0 ? -0.4 : 0.4));
      CHECK(way.norm() == doctest::Approx(0.4));
      CHECK(std::abs(motion.front().position[axis]) > 0.4);
    }
  }
}

TEST_CASE("upload: names are safe and free") {
  Place place;
  MeshUploads uploads(place.library, place.loading);
  CHECK(uploads.add("../../etc/pass wd.obj", box_obj(Vec3(1, 1, 2))).name == "pass_wd");
  CHECK(uploads.add("pass wd.obj", box_obj(Vec3(1, 1, 2))).name == "pass_wd-2");
  CHECK(uploads.add(".obj.obj", box_obj(Vec3(1, 1, 2))).name == "_obj");
}

TEST_CASE("upload: what is no solid is refused with what is wrong, and offers nothing") {
  Place place;
  MeshUploads uploads(place.library, place.loading);
  CHECK(why(uploads, "a.exe", "MZ").find("allowed are obj, stl, ply") != std::string::npos);
  CHECK(why(uploads, "noise.stl", std::string(3000, '\7')) != "");
  CHECK(why(uploads, "empty.obj", "") != "");
  CHECK(why(uploads, "flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").find("flat.obj") !=
        std::string::npos);
  CHECK(why(uploads, "huge.obj", box_obj(Vec3(1e300, 1, 1))) != "");
  CHECK(place.library.names().empty());
}

TEST_CASE("upload: the oldest goes when there are many, and the folder goes with its owner") {
  Place place;
  const auto leftovers = [] {
    int count = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::temp_directory_path()))
      count += entry.path().filename().string().starts_with("rend-meshes-");
    return count;
  };
  const int before = leftovers();
  {
    MeshUploads uploads(place.library, place.loading);
    CHECK(leftovers() == before + 1);
    for (std::size_t n = 0; n <= MeshUploads::kMostUploads; ++n)
      uploads.add(fmt::format("m{}.obj", n), box_obj(Vec3(1, 1, 2)));
    const std::vector<std::string> names = place.library.names();
    CHECK(names.size() == MeshUploads::kMostUploads);
    CHECK(std::find(names.begin(), names.end(), "m0") == names.end());
  }
  CHECK(leftovers() == before);
}
