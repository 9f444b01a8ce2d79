// Splits vertices whose corners need different normals or kinds.
#include "render/corner_mesh.h"

#include "engine/core/error.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace rend {

namespace {

const float kCreaseCosine = static_cast<float>(std::cos(kCreaseAngle * std::numbers::pi / 180));

/// Twice the area of a triangle times its normal.
Vec3f area_normal(const std::vector<Vec3f>& x, const Triangle& t) {
  const Vec3f& a = x[static_cast<std::size_t>(t[0])];
  return (x[static_cast<std::size_t>(t[1])] - a).cross(x[static_cast<std::size_t>(t[2])] - a);
}

Vec3f unit(const Vec3f& v) {
  const float length = v.norm();
  return length > 1e-30f ? Vec3f(v / length) : Vec3f(0, 1, 0);
}

/// A surface in single precision with what its corners need.
struct Source {
  std::vector<Vec3f> x;
  const std::vector<Triangle>& triangles;
  const Vec3f* normal = nullptr;         ///< #V, only read where a vertex is whole
  const std::uint8_t* crease = nullptr;  ///< #V; nullptr: every vertex
  const std::uint8_t* crack = nullptr;   ///< #T; nullptr: no crack faces
  bool is_prop = false;

  Kind kind(std::size_t t) const {
    if (is_prop) return Kind::prop;
    return crack && crack[t] ? Kind::crack : Kind::skin;
  }
};

void check_triangles(const char* where, const std::vector<Triangle>& triangles,
                     std::size_t vertices) {
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const Index v : triangles[t])
      if (v < 0 || static_cast<std::size_t>(v) >= vertices)
        throw Error(where, fmt::format("triangle {} names vertex {} of {}", t, v, vertices));
}

/// Vertices that are split: marked as crease, or shared by faces of two kinds.
std::vector<std::uint8_t> find_split(const Source& s) {
  if (!s.crease) return std::vector<std::uint8_t>(s.x.size(), 1);
  std::vector<std::uint8_t> split(s.crease, s.crease + s.x.size());
  std::vector<std::uint8_t> seen(s.x.size(), 0);
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const std::uint8_t bit = s.kind(t) == Kind::crack ? 2 : 1;
    for (const Index v : s.triangles[t]) seen[static_cast<std::size_t>(v)] |= bit;
  }
  for (std::size_t v = 0; v < split.size(); ++v) split[v] |= seen[v] == 3;
  return split;
}

/// Corners of split vertices, grouped by vertex (compressed rows).
struct CornerLists {
  std::vector<std::uint32_t> begin;   ///< #V + 1
  std::vector<std::uint32_t> corner;  ///< 3 * triangle + side
};

CornerLists list_corners(const Source& s, const std::vector<std::uint8_t>& split) {
  CornerLists lists;
  lists.begin.assign(s.x.size() + 1, 0);
  for (const Triangle& t : s.triangles)
    for (const Index v : t)
      lists.begin[static_cast<std::size_t>(v) + 1] += split[static_cast<std::size_t>(v)];
  for (std::size_t v = 0; v < s.x.size(); ++v) lists.begin[v + 1] += lists.begin[v];
  lists.corner.resize(lists.begin.back());
  std::vector<std::uint32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(s.triangles[t][k]);
      if (split[v]) lists.corner[next[v]++] = static_cast<std::uint32_t>(3 * t + k);
    }
  return lists;
}

/// Writes the number of the vertex that `emit(v, normal, kind)` makes for every corner.
template <class Emit>
void split_corners(const Source& s, const Emit& emit, std::uint32_t* const indices) {
  const std::vector<std::uint8_t> split = find_split(s);
  const CornerLists lists = list_corners(s, split);
  struct Face {
    Vec3f area, normal;
    Kind kind;
    Vec3f corner_normal;
    std::uint32_t vertex;
  };
  std::vector<Face> faces;
  std::vector<std::uint32_t> whole(s.x.size(), ~0u);
  for (std::size_t v = 0; v < s.x.size(); ++v) {
    if (!split[v]) continue;
    faces.clear();
    for (std::uint32_t i = lists.begin[v]; i < lists.begin[v + 1]; ++i) {
      const std::size_t t = lists.corner[i] / 3;
      const Vec3f area = area_normal(s.x, s.triangles[t]);
      faces.push_back({area, unit(area), s.kind(t), Vec3f::Zero(), 0});
    }
    for (std::size_t i = 0; i < faces.size(); ++i) {
      Face& face = faces[i];
      Vec3f sum = Vec3f::Zero();
      for (const Face& other : faces)
        if (other.kind == face.kind && other.normal.dot(face.normal) > kCreaseCosine)
          sum += other.area;
      face.corner_normal = unit(sum);
      bool found = false;
      for (std::size_t j = 0; j < i && !found; ++j)
        if (faces[j].kind == face.kind &&
            faces[j].corner_normal.dot(face.corner_normal) > 0.9998f) {
          face.vertex = faces[j].vertex;
          found = true;
        }
      if (!found) face.vertex = emit(v, face.corner_normal, face.kind);
      indices[lists.corner[lists.begin[v] + i]] = face.vertex;
    }
  }
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(s.triangles[t][k]);
      if (split[v]) continue;
      if (whole[v] == ~0u) whole[v] = emit(v, s.normal[v], s.kind(t));
      indices[3 * t + k] = whole[v];
    }
}

template <class Value>
void append(const Source& s, const Value& value, CornerMesh& out) {
  const std::size_t first = out.indices.size();
  out.vertices.reserve(out.vertices.size() + s.x.size() + s.x.size() / 4);
  out.indices.resize(first + 3 * s.triangles.size());
  const std::uint32_t* const indices = out.indices.data() + first;
  const auto emit = [&](std::size_t v, const Vec3f& normal, Kind kind) {
    const Vec3f& x = s.x[v];
    out.vertices.push_back({{x.x(), x.y(), x.z()}, pack_normal(normal, kind), value(v, kind)});
    return static_cast<std::uint32_t>(out.vertices.size() - 1);
  };
  split_corners(s, emit, out.indices.data() + first);

  bool finite = true;
  for (const Vec3f& x : s.x) finite = finite && x.allFinite();
  if (finite) return;
  std::size_t end = first;
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    bool keep = true;
    for (const Index v : s.triangles[t])
      keep = keep && s.x[static_cast<std::size_t>(v)].allFinite();
    if (!keep) continue;
    for (std::size_t k = 0; k < 3; ++k) out.indices[end + k] = indices[3 * t + k];
    end += 3;
  }
  out.indices.resize(end);
}

}  // namespace

std::uint32_t pack_normal(const Vec3f& normal, Kind kind) {
  std::uint32_t packed = static_cast<std::uint32_t>(kind) << 30;
  for (int i = 0; i < 3; ++i) {
    const float scaled =
        (std::min(1.0f, std::max(-1.0f, normal[i])) * 0.5f + 0.5f) * 1023.0f + 0.5f;
    // A normal that is not finite must not become an undefined conversion.
    const std::uint32_t bits =
        scaled >= 0 && scaled < 1024 ? static_cast<std::uint32_t>(scaled) : 512u;
    packed |= bits << (10 * i);
  }
  return packed;
}

namespace {

Source source_of(const SurfaceMesh& surface) {
  const std::size_t vertices = surface.x.size(), triangles = surface.triangles.size();
  const auto check = [](const char* name, std::size_t length, std::size_t want) {
    if (length != want)
      throw Error("surface", fmt::format("{} has {} entries instead of {}", name, length, want));
  };
  check("normal", surface.normal.size(), vertices);
  check("damage", surface.damage.size(), vertices);
  check("crease", surface.crease.size(), vertices);
  check("interior", surface.interior.size(), triangles);
  check_triangles("surface", surface.triangles, vertices);
  Source source{
      {}, surface.triangles, surface.normal.data(), surface.crease.data(), surface.interior.data()};
  source.x.reserve(vertices);
  for (const Vec3& x : surface.x) source.x.push_back(x.cast<float>());
  return source;
}

}  // namespace

void append_surface(const SurfaceMesh& surface, const std::vector<float>& value, CornerMesh& out) {
  if (!value.empty() && value.size() != surface.x.size())
    throw Error("surface", fmt::format("coloring value has {} entries instead of {}", value.size(),
                                       surface.x.size()));
  append(
      source_of(surface),
      [&](std::size_t v, Kind kind) {
        if (kind == Kind::crack) return surface.damage[v];
        return value.empty() ? 0.0f : value[v];
      },
      out);
}

SplitSurface split_surface(const SurfaceMesh& surface) {
  SplitSurface out;
  out.corner.resize(3 * surface.triangles.size());
  const auto emit = [&](std::size_t v, const Vec3f& normal, Kind) {
    out.vertex.push_back(static_cast<Index>(v));
    out.normal.push_back(normal);
    return static_cast<std::uint32_t>(out.vertex.size() - 1);
  };
  split_corners(source_of(surface), emit, out.corner.data());
  return out;
}

void append_prop(const Prop& prop, CornerMesh& out) {
  check_triangles("prop", prop.triangles, prop.x.size());
  Source source{prop.x, prop.triangles};
  source.is_prop = true;
  append(
      source, [](std::size_t, Kind) { return 0.0f; }, out);
}

}  // namespace rend
