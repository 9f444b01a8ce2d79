// Mesh files as other programs read them: the same closed surface and the same fields in every
// format.
#include "app/frame_arrays.h"
#include "app/frame_formats.h"
#include "bench/torn_shapes.h"
#include "engine/core/error.h"
#include "engine/mesh/mesh_import.h"
#include "tests/app/program.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

using namespace rend;
using nlohmann::json;

namespace {

/// Positions are whole numbers of these in a metre, so that text may lose the last bit of a float.
constexpr Real kUnits = 8192;

/// A torn ring: crack faces, rims, two pieces; fields that tell every vertex from every other.
SurfaceMesh sample() {
  SurfaceMesh mesh = torn_torus(3000);
  for (std::size_t v = 0; v < mesh.x.size(); ++v) {
    const auto number = static_cast<float>(v);
    for (Real& coordinate : mesh.x[v]) coordinate = std::round(kUnits * coordinate) / kUnits;
    mesh.rest[v] = 2 * mesh.x[v] + Vec3(1, 2, 3);
    mesh.stress[v] = 10 * number;
    mesh.speed[v] = 0.5f * number;
  }
  return mesh;
}

Snapshot sample_particles(Model& model) {
  Snapshot s;
  s.time = 0.25;
  for (int p = 0; p < 5; ++p) {
    s.x.emplace_back(p, 2 * p, 3 * p);
    model.X.emplace_back(p, 0, 0);
    model.body.push_back(static_cast<std::uint16_t>(p / 3));
    s.v.emplace_back(0.f, static_cast<float>(p), 0.f);
    s.damage.push_back(0.2f * static_cast<float>(p));
    s.stress.push_back(100.f * static_cast<float>(p));
    s.yielded.push_back(p % 2);
  }
  return s;
}

std::string surface_bytes(const SurfaceMesh& mesh, const char* format) {
  return find_frame_format("test", format).surface(mesh, 0.25);
}

/// Corner positions of all triangles, smallest corner first, as a sorted list: what a file must
/// keep whatever it does to the numbering.
using Shape = std::vector<std::array<std::array<long, 3>, 3>>;

void add_triangle(Shape& shape, std::array<std::array<long, 3>, 3> corner) {
  std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
  shape.push_back(corner);
}

template <class Positions>
Shape shape_of(const Positions& x, const std::vector<Triangle>& triangles) {
  Shape shape;
  for (const Triangle& t : triangles) {
    std::array<std::array<long, 3>, 3> corner;
    for (std::size_t k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        corner[k][static_cast<std::size_t>(axis)] =
            std::lround(kUnits * x[static_cast<std::size_t>(t[k])][axis]);
    add_triangle(shape, corner);
  }
  std::sort(shape.begin(), shape.end());
  return shape;
}

/// The XML header of a VTK file and the arrays it points to.
struct VtkFile {
  std::string header;
  std::string data;

  explicit VtkFile(const std::string& bytes) {
    const std::string mark = "<AppendedData encoding=\"raw\">\n_";
    const std::size_t at = bytes.find(mark);
    REQUIRE(at != std::string::npos);
    header = bytes.substr(0, at);
    data = bytes.substr(at + mark.size());
  }

  template <class T>
  std::vector<T> array(const std::string& name, const char* type) const {
    const std::size_t at = header.find(" Name=\"" + name + "\"");
    CAPTURE(name);
    REQUIRE(at != std::string::npos);
    const std::size_t tag = header.rfind('<', at);
    CHECK(header.compare(tag, 17 + std::strlen(type), fmt::format("<DataArray type=\"{}", type)) ==
          0);
    std::size_t offset = std::stoul(header.substr(header.find("offset=\"", at) + 8));
    std::uint64_t size = 0;
    REQUIRE(offset + 8 <= data.size());
    std::memcpy(&size, data.data() + offset, 8);
    REQUIRE(offset + 8 + size <= data.size());
    std::vector<T> values(size / sizeof(T));
    std::memcpy(values.data(), data.data() + offset + 8, size);
    return values;
  }
};

/// JSON and binary chunk of a GLB file.
struct GlbFile {
  json doc;
  std::string data;

  explicit GlbFile(const std::string& bytes) {
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      std::memcpy(&value, bytes.data() + at, 4);
      return value;
    };
    REQUIRE(bytes.substr(0, 4) == "glTF");
    CHECK(word(4) == 2);
    REQUIRE(word(8) == bytes.size());
    REQUIRE(bytes.substr(16, 4) == "JSON");
    doc = json::parse(bytes.substr(20, word(12)));
    const std::size_t at = 20 + word(12);
    CHECK(at % 4 == 0);
    CHECK(bytes.substr(at + 4, 4) == std::string("BIN\0", 4));
    REQUIRE(word(at) == bytes.size() - at - 8);
    data = bytes.substr(at + 8);
  }

  template <class T>
  std::vector<T> read(int accessor) const {
    const json& a = doc["accessors"][static_cast<std::size_t>(accessor)];
    const json& view = doc["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::map<std::string, std::size_t> width = {{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};
    std::vector<T> values(a["count"].get<std::size_t>() * width.at(a["type"]));
    CHECK(view["byteOffset"].get<std::size_t>() % 4 == 0);
    REQUIRE(view["byteLength"].get<std::size_t>() == values.size() * sizeof(T));
    REQUIRE(view["byteOffset"].get<std::size_t>() + values.size() * sizeof(T) <= data.size());
    std::memcpy(values.data(), data.data() + view["byteOffset"].get<std::size_t>(),
                values.size() * sizeof(T));
    return values;
  }
  std::vector<float> attribute(const std::string& name) const {
    CAPTURE(name);
    REQUIRE(doc["meshes"][0]["primitives"][0]["attributes"].contains(name));
    return read<float>(doc["meshes"][0]["primitives"][0]["attributes"][name]);
  }
};

}  // namespace

TEST_CASE("another program reads the same closed surface from PLY, OBJ and GLB") {
  const SurfaceMesh mesh = sample();
  const Shape wanted = shape_of(mesh.x, mesh.triangles);
  for (const std::string format : {"ply", "obj", "glb"}) {
    CAPTURE(format);
    const TriangleSurface read =
        import_mesh_bytes(surface_bytes(mesh, format.c_str()), "torn." + format);
    CHECK(shape_of(read.positions, read.triangles) == wanted);
  }
}

TEST_CASE("VTP: every array with its type and values") {
  const SurfaceMesh mesh = sample();
  const VtkFile file(surface_bytes(mesh, "vtp"));
  const auto x = file.array<float>("position", "Float32");
  REQUIRE(x.size() == 3 * mesh.x.size());
  CHECK(x[4] == static_cast<float>(mesh.x[1].y()));
  CHECK(file.array<float>("rest", "Float32")[5] == static_cast<float>(mesh.rest[1].z()));
  CHECK(file.array<float>("normal", "Float32")[3] == mesh.normal[1].x());
  CHECK(file.array<float>("damage", "Float32") == mesh.damage);
  CHECK(file.array<float>("stress", "Float32") == mesh.stress);
  CHECK(file.array<float>("speed", "Float32") == mesh.speed);
  CHECK(file.array<std::uint8_t>("interior", "UInt8") == mesh.interior);
  CHECK(file.array<Index>("piece", "Int32") == mesh.piece);
  CHECK(file.array<Real>("TimeValue", "Float64") == std::vector<Real>{0.25});
  const auto corner = file.array<Index>("connectivity", "Int32");
  REQUIRE(corner.size() == 3 * mesh.triangles.size());
  CHECK(std::equal(corner.begin(), corner.end(), mesh.triangles.front().begin()));
  CHECK(file.array<Index>("offsets", "Int32").back() == static_cast<Index>(corner.size()));
}

TEST_CASE("VTK reads the same closed surface and fields, where it is installed") {
  const SurfaceMesh mesh = sample();
  const test::TemporaryFolder folder;
  const auto file = folder.write("torn.vtp", surface_bytes(mesh, "vtp"));
  const test::Outcome read =
      test::run_command(fmt::format("python3 '{}' '{}'", REND_SOURCE_DIR "/tests/app/read_vtp.py", file.string()));
  if (read.exit_code == 77 || read.exit_code == 127) {
    MESSAGE("skipped: python3-vtk9 is not installed");
    return;
  }
  CAPTURE(read.text);
  REQUIRE(read.exit_code == 0);
  const std::size_t points = mesh.x.size(), triangles = mesh.triangles.size();
  const auto has = [&](const std::string& line) {
    CAPTURE(line);
    CHECK(read.text.find(line + "\n") != std::string::npos);
  };
  has(fmt::format("points {}", points));
  has(fmt::format("triangles {}", triangles));
  has("open or non-manifold edges 0");
  const Vec3 rest = mesh.rest.back();
  has(fmt::format("point rest {} {:.7g} {:.7g} {:.7g}", points, rest.x(), rest.y(), rest.z()));
  has(fmt::format("point damage {} {:.7g}", points, mesh.damage.back()));
  has(fmt::format("point stress {} {:.7g}", points, mesh.stress.back()));
  has(fmt::format("point speed {} {:.7g}", points, mesh.speed.back()));
  has(fmt::format("cell piece {} {}", triangles, mesh.piece.back()));
  has(fmt::format("cell interior {} {}", triangles, mesh.interior.back()));
  has("field TimeValue 1 0.25");
}

TEST_CASE("GLB: skin and crack apart, fields as attributes, sharp rims") {
  const SurfaceMesh mesh = sample();
  const GlbFile file(surface_bytes(mesh, "glb"));
  const json& primitives = file.doc["meshes"][0]["primitives"];
  REQUIRE(primitives.size() == 2);
  CHECK(file.doc["nodes"][0]["extras"]["time"] == 0.25);
  const auto x = file.attribute("POSITION"), n = file.attribute("NORMAL"),
             rest = file.attribute("_REST");
  const auto damage = file.attribute("_DAMAGE"), stress = file.attribute("_STRESS"),
             speed = file.attribute("_SPEED"), piece = file.attribute("_PIECE");
  CHECK(damage.size() > mesh.x.size());  // rims are split
  const auto crack_triangles =
      static_cast<std::size_t>(std::count(mesh.interior.begin(), mesh.interior.end(), 1));
  const std::vector<std::uint32_t> corners[2] = {
      file.read<std::uint32_t>(primitives[0]["indices"]),
      file.read<std::uint32_t>(primitives[1]["indices"])};
  CHECK(corners[0].size() == 3 * (mesh.triangles.size() - crack_triangles));
  CHECK(corners[1].size() == 3 * crack_triangles);
  for (int kind = 0; kind < 2; ++kind) {
    CHECK(file.doc["materials"][primitives[kind]["material"].get<std::size_t>()]["name"] ==
          (kind ? "crack" : "skin"));
    std::size_t k = 0;
    bool same = true;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.interior[t] != kind) continue;
      for (Index corner : mesh.triangles[t]) {
        const auto v = static_cast<std::size_t>(corner);
        const std::size_t u = corners[kind][k++];
        same = same && damage[u] == mesh.damage[v] && stress[u] == mesh.stress[v] &&
               speed[u] == mesh.speed[v] && piece[u] == static_cast<float>(mesh.piece[t]);
        for (std::size_t axis = 0; axis < 3; ++axis)
          same = same && x[3 * u + axis] == static_cast<float>(mesh.x[v][static_cast<int>(axis)]) &&
                 rest[3 * u + axis] == static_cast<float>(mesh.rest[v][static_cast<int>(axis)]);
      }
    }
    CHECK(same);
  }
  for (std::size_t u = 0; u < damage.size(); ++u)
    REQUIRE(Vec3f(n[3 * u], n[3 * u + 1], n[3 * u + 2]).norm() == doctest::Approx(1).epsilon(1e-4));
}

TEST_CASE(
    "OBJ: a group for each piece and kind, materials that exist, closed in its own numbering") {
  const SurfaceMesh mesh = sample();
  std::istringstream text(surface_bytes(mesh, "obj"));
  std::map<std::string, int> faces, directed;
  std::map<std::string, std::size_t> rows;
  std::string line, group, material;
  while (std::getline(text, line)) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    ++rows[key];
    if (key == "g") words >> group;
    if (key == "usemtl") words >> material;
    if (key != "f") continue;
    ++faces[group + " " + material];
    std::string corner[3];
    for (std::string& c : corner) {
      words >> c;
      c = c.substr(0, c.find('/'));
    }
    for (int k = 0; k < 3; ++k) ++directed[corner[k] + ">" + corner[(k + 1) % 3]];
  }
  CHECK(rows["v"] == mesh.x.size());
  CHECK(rows["vt"] == mesh.x.size());
  CHECK(rows["vn"] > mesh.x.size());
  std::map<std::string, int> wanted;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const char* kind = mesh.interior[t] ? "crack" : "skin";
    ++wanted[fmt::format("piece_{}_{} {}", mesh.piece[t], kind, kind)];
  }
  CHECK(wanted.size() == 4);
  CHECK(faces == wanted);
  for (const auto& [edge, uses] : directed) {
    const std::size_t mid = edge.find('>');
    REQUIRE(uses == 1);
    REQUIRE(directed.count(edge.substr(mid + 1) + ">" + edge.substr(0, mid)) == 1);
  }
}

TEST_CASE("particles in every format") {
  Model model;
  const Snapshot s = sample_particles(model);
  const auto bytes = [&](const char* format) {
    return find_frame_format("test", format).particles(s, model);
  };
  const VtkFile vtp(bytes("vtp"));
  CHECK(vtp.array<float>("stress", "Float32") == s.stress);
  CHECK(vtp.array<Index>("id", "Int32") == std::vector<Index>{0, 1, 2, 3, 4});
  CHECK(vtp.array<Index>("connectivity", "Int32").size() == 5);
  CHECK(vtp.array<std::uint8_t>("yielded", "UInt8") == s.yielded);
  const GlbFile glb(bytes("glb"));
  CHECK(glb.doc["meshes"][0]["primitives"][0]["mode"] == 0);
  CHECK(glb.attribute("_DAMAGE") == s.damage);
  CHECK(glb.attribute("_VELOCITY")[4] == 1);
  CHECK(glb.attribute("POSITION")[14] == 12);
  const std::string obj = bytes("obj");
  CHECK(std::count(obj.begin(), obj.end(), 'v') >= 10);
  CHECK(obj.find("\nv 4 8 12\n") != std::string::npos);
  CHECK(obj.find("\np 5\n") != std::string::npos);
  CHECK(bytes("ply").starts_with("ply\nformat binary_little_endian 1.0\n"));
}

TEST_CASE("run and remesh write the formats that are asked for, and a series for ParaView") {
  const test::TemporaryFolder folder;
  const auto scene = folder.write("small.json", test::small_scene());
  const auto out = folder.path() / "out", again = folder.path() / "again";
  const auto files = [](const std::filesystem::path& in) {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(in)) {
      CHECK(entry.path().extension() != ".tmp");
      CHECK(entry.file_size() > 50);
      ++count;
    }
    return count;
  };
  const auto run = test::run_rend(
      fmt::format("run '{}' --frames 2 --no-png --formats ply,vtp,obj,glb --out '{}'",
                  scene.string(), out.string()));
  CAPTURE(run.text);
  REQUIRE(run.exit_code == 0);
  CHECK(files(out / "mesh") == 9);
  CHECK(files(out / "particles") == 8);
  std::stringstream series;
  series << std::ifstream(out / "mesh.pvd").rdbuf();
  CHECK(series.str().find("file=\"mesh/000002.vtp\"") != std::string::npos);
  CHECK(std::filesystem::exists(out / "particles.pvd"));
  const auto remesh = test::run_rend(
      fmt::format("remesh '{}' --no-png --formats vtp --out '{}'", out.string(), again.string()));
  CAPTURE(remesh.text);
  REQUIRE(remesh.exit_code == 0);
  CHECK(files(again / "mesh") == 2);
  const auto wrong = test::run_rend(fmt::format("run '{}' --formats stl --out '{}'", scene.string(),
                                                (folder.path() / "none").string()));
  CHECK(wrong.exit_code == 2);
  CHECK(wrong.text.find("ply, vtp, obj, glb") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder.path() / "none"));
}
