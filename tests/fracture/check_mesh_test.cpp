// The checker finds what is wrong with meshes that were broken on purpose.
#include "engine/fracture/check_mesh.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace rend;

namespace {

SurfaceMesh octahedron(const Vec3& at = Vec3::Zero(), Index piece = 0, Index first = 0) {
  SurfaceMesh m;
  for (int axis = 0; axis < 3; ++axis)
    for (int sign : {1, -1}) m.x.push_back(at + sign * Vec3::Unit(axis));
  for (int x = 0; x < 2; ++x)
    for (int y = 0; y < 2; ++y)
      for (int z = 0; z < 2; ++z) {
        Triangle t{first + x, first + 2 + y, first + 4 + z};
        if ((x + y + z) % 2) std::swap(t[1], t[2]);
        m.triangles.push_back(t);
        m.piece.push_back(piece);
      }
  return m;
}

void append(SurfaceMesh& m, const SurfaceMesh& other) {
  m.x.insert(m.x.end(), other.x.begin(), other.x.end());
  m.triangles.insert(m.triangles.end(), other.triangles.begin(), other.triangles.end());
  m.piece.insert(m.piece.end(), other.piece.begin(), other.piece.end());
}

}  // namespace

TEST_CASE("good meshes pass, with the volume of each piece, far from the origin too") {
  SurfaceMesh m = octahedron();
  append(m, octahedron({1e6, 0, 0}, 7, 6));
  const MeshCheck check = check_mesh(m);
  CHECK_MESSAGE(check.good(), check.text());
  CHECK(check.piece == std::vector<Index>{0, 7});
  CHECK(check.volume[0] == doctest::Approx(4. / 3).epsilon(1e-14));
  CHECK(check.volume[1] == doctest::Approx(4. / 3).epsilon(1e-9));
  CHECK(enclosed_volume(octahedron()) == doctest::Approx(4. / 3).epsilon(1e-14));
  CHECK(check_mesh(SurfaceMesh{}).good());
  CHECK(enclosed_volume(SurfaceMesh{}) == 0);
}

TEST_CASE("a hole") {
  SurfaceMesh m = octahedron();
  m.triangles.pop_back();
  m.piece.pop_back();
  const MeshCheck check = check_mesh(m);
  CHECK(check.open_edges == 3);
  CHECK(check.split_links == 3);
}

TEST_CASE("one triangle turned over") {
  SurfaceMesh m = octahedron();
  std::swap(m.triangles[3][0], m.triangles[3][1]);
  const MeshCheck check = check_mesh(m);
  CHECK(check.repeated_edges == 3);
  CHECK(check.open_edges > 0);
}

TEST_CASE("everything turned over") {
  SurfaceMesh m = octahedron();
  for (Triangle& t : m.triangles) std::swap(t[0], t[1]);
  const MeshCheck check = check_mesh(m);
  CHECK(check.open_edges == 0);
  CHECK(check.inside_out == 1);
}

TEST_CASE("two bodies that share a vertex, or an edge") {
  SurfaceMesh point = octahedron();
  append(point, octahedron({2, 0, 0}, 0, 6));
  for (Triangle& t : point.triangles)
    for (Index& v : t)
      if (v == 7) v = 0;  // the -x corner of the second is the +x corner of the first
  MeshCheck check = check_mesh(point);
  CHECK(check.split_links == 1);
  CHECK(check.unused_vertices == 1);
  CHECK(check.open_edges == 0);
  SurfaceMesh edge = point;
  for (Triangle& t : edge.triangles)
    for (Index& v : t)
      if (v == 8) v = 2;
  check = check_mesh(edge);
  CHECK(check.split_links == 2);
  CHECK(check.repeated_edges == 2);
}

TEST_CASE("bad indices, repeated corners, numbers that are none") {
  SurfaceMesh m = octahedron();
  m.triangles[0][1] = 99;
  m.triangles[1][1] = m.triangles[1][0];
  m.triangles[2][0] = -1;
  m.x[3].y() = NAN;
  const MeshCheck check = check_mesh(m);
  CHECK(check.degenerate == 3);
  CHECK(check.not_finite == 1);
  CHECK_FALSE(check.good());
}
