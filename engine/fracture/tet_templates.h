// How a tet with some broken edges is cut: one small triangle list for each of the 64 sets of
// broken edges.
#pragma once

#include <array>
#include <cstdint>

namespace rend {

/// Local numbering of a tet with vertices sorted by particle id: edges ab ac ad bc bd cd, faces abc
/// abd acd bcd.
inline constexpr int edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
inline constexpr int face_corners[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
inline constexpr int face_edges[4][3] = {{0, 1, 3}, {0, 2, 4}, {1, 2, 5}, {3, 4, 5}};  ///< 01 02 12
inline constexpr int edge_faces[6][2] = {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}};

/// Broken edges of a face (bits 01 02 12) out of those of its tet.
constexpr int face_mask(int tet_mask, int face) {
  return (tet_mask >> face_edges[face][0] & 1) | (tet_mask >> face_edges[face][1] & 1) << 1 |
         (tet_mask >> face_edges[face][2] & 1) << 2;
}

/// A corner of a cut: the middle of edge e on the side of its end s is 2e+s, the centre of face f
/// for the component with lowest corner r is 12+3f+r, the centre of the tet for the component of r
/// is 24+r.
using CornerCode = std::uint8_t;
inline constexpr CornerCode face_code = 12, tet_code = 24, code_count = 28;

/// Triangles of one mask in a positively oriented tet (det(b-a, c-a, d-a) > 0), normals out of the
/// matter they bound. A face with one or three broken edges is met at its centre, with two from
/// middle to middle: the rule sees nothing but the face, so neighbours agree. Where no face has
/// three broken edges, the cut is a plain polygon on each side (marching-tet triangle or quad, or a
/// slit that ends inside the tet); else a fan around the centre of the tet.
struct TetTemplate {
  std::uint8_t triangle_count = 0;
  bool needs_centre = false;
  std::array<std::array<CornerCode, 3>, 24> triangles;
};

/// All masks, and the components of a tet (64 masks) and of a face (8 masks) through unbroken
/// edges: the representative of a vertex is the lowest local vertex of its component.
struct TetTemplates {
  TetTemplates();
  std::array<TetTemplate, 64> tet;
  std::uint8_t tet_component[64][4];
  std::uint8_t face_component[8][3];
};

const TetTemplates& tet_templates();

}  // namespace rend
