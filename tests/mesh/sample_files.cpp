// Writers of the four plain formats.
#include "tests/mesh/sample_files.h"

#include <fmt/format.h>

namespace rend {

TriangleSurface cube_surface(const Vec3& low, Real side) {
  TriangleSurface s;
  for (int c = 0; c < 8; ++c)
    s.positions.push_back(low + side * Vec3(c & 1, c >> 1 & 1, c >> 2 & 1));
  s.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return s;
}

TriangleSurface merged(const TriangleSurface& a, const TriangleSurface& b) {
  TriangleSurface s = a;
  const Index first = Index(a.positions.size());
  s.positions.insert(s.positions.end(), b.positions.begin(), b.positions.end());
  for (const Triangle& t : b.triangles)
    s.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return s;
}

namespace {

std::string rows(const TriangleSurface& s, const char* vertex, const char* face, Index base) {
  std::string text;
  for (const Vec3& x : s.positions)
    text += fmt::format("{}{} {} {}\n", vertex, x.x(), x.y(), x.z());
  for (const Triangle& t : s.triangles)
    text += fmt::format("{}{} {} {}\n", face, t[0] + base, t[1] + base, t[2] + base);
  return text;
}

}  // namespace

std::string as_obj(const TriangleSurface& s) { return rows(s, "v ", "f ", 1); }

std::string as_off(const TriangleSurface& s) {
  return fmt::format("OFF\n{} {} 0\n", s.positions.size(), s.triangles.size()) +
         rows(s, "", "3 ", 0);
}

std::string as_ply(const TriangleSurface& s) {
  return fmt::format(
             "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float "
             "y\nproperty float z\n"
             "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
             s.positions.size(), s.triangles.size()) +
         rows(s, "", "3 ", 0);
}

std::string as_stl(const TriangleSurface& s) {
  std::string text = "solid test\n";
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) {
      const Vec3 x = s.corner(t, k);
      text += fmt::format("vertex {} {} {}\n", x.x(), x.y(), x.z());
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid test\n";
}

}  // namespace rend
