// Binary PLY files.
#include "app/ply.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

namespace rend {

static_assert(std::endian::native == std::endian::little, "PLY is written as it lies in memory");

namespace {

template <class T>
void put(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

template <class V>
void put_vector(std::string& out, const V& v) {
  for (int axis = 0; axis < 3; ++axis) put(out, static_cast<float>(v[axis]));
}

constexpr const char* kHeader =
    "ply\nformat binary_little_endian 1.0\ncomment rend " REND_VERSION "; metres, seconds, pascal; y is up\n";

}  // namespace

std::string surface_ply(const SurfaceMesh& mesh) {
  std::string out = kHeader;
  out += fmt::format("element vertex {}\n", mesh.vertex_count());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "rest_x", "rest_y", "rest_z", "damage", "stress", "speed"})
    out += fmt::format("property float {}\n", name);
  out += fmt::format(
      "element face {}\nproperty list uchar int vertex_indices\nproperty uchar interior\nproperty int piece\n"
      "end_header\n",
      mesh.triangle_count());
  out.reserve(out.size() + mesh.x.size() * 48 + mesh.triangles.size() * 18);
  for (std::size_t v = 0; v < mesh.x.size(); ++v) {
    put_vector(out, mesh.x[v]);
    put_vector(out, mesh.normal[v]);
    put_vector(out, mesh.rest[v]);
    put(out, mesh.damage[v]);
    put(out, mesh.stress[v]);
    put(out, mesh.speed[v]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    put(out, std::uint8_t{3});
    for (Index corner : mesh.triangles[t]) put(out, corner);
    put(out, mesh.interior[t]);
    put(out, mesh.piece[t]);
  }
  return out;
}

std::string particles_ply(const Snapshot& snapshot, const Model& model) {
  std::string out = kHeader;
  out += fmt::format("element vertex {}\nproperty int id\n", snapshot.x.size());
  for (const char* name :
       {"x", "y", "z", "rest_x", "rest_y", "rest_z", "vx", "vy", "vz", "damage", "stress"})
    out += fmt::format("property float {}\n", name);
  out += "property uchar yielded\nproperty ushort body\nend_header\n";
  out.reserve(out.size() + snapshot.x.size() * 51);
  for (std::size_t p = 0; p < snapshot.x.size(); ++p) {
    put(out, static_cast<Index>(p));
    put_vector(out, snapshot.x[p]);
    put_vector(out, model.X[p]);
    put_vector(out, snapshot.v[p]);
    put(out, snapshot.damage[p]);
    put(out, snapshot.stress[p]);
    put(out, snapshot.yielded[p]);
    put(out, model.body[p]);
  }
  return out;
}

}  // namespace rend
