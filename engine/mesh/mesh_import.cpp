// Checks files before the loader sees them, and everything the loader says.
#include "engine/mesh/mesh_import.h"

#include "engine/core/error.h"
#include "engine/mesh/loader_process.h"
#include "engine/mesh/mesh_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>

namespace rend {

namespace {

constexpr const char* allowed_endings[] = {"obj", "stl", "ply", "off", "gltf", "glb"};
// Beyond any model in metres; larger numbers lose all digits in the importer's floats.
constexpr float largest_coordinate = 1e12f;

[[noreturn]] void fail(const std::string& name, const std::string& why) {
  throw Error("file", name + " " + why);
}

std::string ending_of(const std::string& name) {
  std::string e = std::filesystem::path(name).extension().string();
  if (!e.empty()) e.erase(0, 1);
  for (char& c : e) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  if (std::find(std::begin(allowed_endings), std::end(allowed_endings), e) ==
      std::end(allowed_endings))
    fail(name,
         fmt::format("has the ending \"{}\"; allowed are obj, stl, ply, off, gltf and glb", e));
  return e;
}

void check_content(std::string_view bytes, const std::string& ending, const std::string& name) {
  if (bytes.empty()) fail(name, "is empty");
  const auto starts = [&](std::string_view word) { return bytes.substr(0, word.size()) == word; };
  if (ending == "ply" && !starts("ply"))
    fail(name, "is not a PLY file: it does not begin with \"ply\"");
  if (ending == "glb" && !starts("glTF"))
    fail(name, "is not a GLB file: it does not begin with \"glTF\"");
  if (ending == "gltf") {
    const auto first = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    if (first == bytes.npos || bytes[first] != '{')
      fail(name, "is not a glTF file: it is no JSON object");
  }
}

// Error text may carry bytes of the file.
std::string printable(std::string text) {
  std::erase_if(text, [](char c) { return c < 32 || c > 126; });
  return text.substr(0, 300);
}

TriangleSurface decode(const std::string& stream, const std::string& name) {
  MeshStreamHeader header;
  if (stream.size() < sizeof header) fail(name, "is damaged: the mesh loader gave up");
  std::memcpy(&header, stream.data(), sizeof header);
  const std::uint64_t rest = stream.size() - sizeof header;
  if (header.magic != mesh_stream_magic)
    fail(name, "is damaged: the mesh loader answered nonsense");
  if (header.is_error) {
    std::string reason = printable(stream.substr(sizeof header));
    if (reason.find("referenced file") != reason.npos)
      reason += "; a mesh must be complete in one file (glb, or gltf with embedded buffers)";
    if (reason.find("bad_alloc") != reason.npos) reason = "that takes too much memory";
    fail(name, "cannot be read: " + reason);
  }
  if (header.vertices > rest / 12 || header.triangles > rest / 12 ||
      12 * (header.vertices + header.triangles) != rest || header.vertices > 0x7fffffff)
    fail(name, "is damaged: the mesh loader answered nonsense");
  TriangleSurface surface;
  surface.positions.reserve(header.vertices);
  surface.triangles.reserve(header.triangles);
  const char* at = stream.data() + sizeof header;
  for (std::uint64_t v = 0; v < header.vertices; ++v, at += 12) {
    float x[3];
    std::memcpy(x, at, 12);
    for (float c : x)
      // Written so that NaN fails too.
      if (!(std::abs(c) <= largest_coordinate))
        fail(name,
             fmt::format("has the vertex ({}, {}, {}); coordinates must be numbers within +-1e12",
                         x[0], x[1], x[2]));
    surface.positions.emplace_back(x[0], x[1], x[2]);
  }
  for (std::uint64_t t = 0; t < header.triangles; ++t, at += 12) {
    std::uint32_t i[3];
    std::memcpy(i, at, 12);
    for (std::uint32_t v : i)
      if (v >= header.vertices)
        fail(name, fmt::format("has a face with vertex {} of {}", v, header.vertices));
    surface.triangles.push_back({Index(i[0]), Index(i[1]), Index(i[2])});
  }
  return surface;
}

}  // namespace

TriangleSurface import_mesh_bytes(std::string_view bytes, const std::string& name,
                                  const MeshLoading& loading) {
  const std::string ending = ending_of(name);
  check_content(bytes, ending, name);
  std::string stream;
  try {
    stream = run_mesh_loader(bytes, ending, loading);
  } catch (const Error& e) {
    fail(name, e.why());
  }
  return decode(stream, name);
}

TriangleSurface import_mesh(const std::filesystem::path& file, const MeshLoading& loading) {
  const std::string name = file.filename().string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) fail(name, "is no regular file");
  const auto size = std::filesystem::file_size(file, error);
  if (error || size > loading.file_bytes)
    fail(name,
         fmt::format("is {} MB large; allowed are {} MB", size >> 20, loading.file_bytes >> 20));
  std::ifstream in(file, std::ios::binary);
  std::string bytes(size, '\0');
  if (!in.read(bytes.data(), std::streamsize(size))) fail(name, "cannot be read");
  return import_mesh_bytes(bytes, name, loading);
}

}  // namespace rend
