// Builds the cut templates from the combinatorics of a tet instead of typing them in.
#include "engine/fracture/tet_templates.h"

#include "engine/core/types.h"

#include <Eigen/Geometry>
#include <bit>
#include <utility>
#include <vector>

namespace rend {

namespace {

// A regular tet makes every wall perpendicular to its edge, so orientation can be read off safely.
Vec3 reference_vertex(int v) {
  static const Vec3 vertices[4] = {{1, 1, 1}, {1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}};
  return vertices[v];
}

Vec3 reference_corner(CornerCode code) {
  if (code < face_code)
    return 0.5 *
           (reference_vertex(edge_ends[code / 2][0]) + reference_vertex(edge_ends[code / 2][1]));
  if (code >= tet_code) return Vec3::Zero();
  Vec3 sum = Vec3::Zero();
  for (int v : face_corners[(code - face_code) / 3]) sum += reference_vertex(v);
  return sum / 3;
}

int corner_of(int face, int vertex) {
  for (int i = 0; i < 3; ++i)
    if (face_corners[face][i] == vertex) return i;
  return -1;
}

int side_of(int edge, int vertex) { return edge_ends[edge][0] == vertex ? 0 : 1; }
int other_end(int edge, int vertex) {
  return edge_ends[edge][edge_ends[edge][0] == vertex ? 1 : 0];
}
CornerCode middle(int edge, int vertex) {
  return static_cast<CornerCode>(2 * edge + side_of(edge, vertex));
}

// The end of `next` on the side of `vertex`, an end of `edge`; both are the broken edges of one
// face.
int same_side(int edge, int vertex, int next) {
  for (int v : edge_ends[next])
    if (v == edge_ends[edge][0] || v == edge_ends[edge][1])
      return v == vertex ? v : other_end(next, v);
  return -1;
}

int partner(int mask, int face, int edge) {
  for (int e : face_edges[face])
    if (e != edge && (mask >> e & 1)) return e;
  return -1;
}

int degree(int mask, int face) {
  return std::popcount(static_cast<unsigned>(face_mask(mask, face)));
}

class Builder {
 public:
  Builder(TetTemplates& all, int mask) : all_(all), out_(all.tet[mask]), mask_(mask) {
    for (int f = 0; f < 4; ++f) out_.needs_centre |= degree(mask, f) == 3;
    if (out_.needs_centre)
      fan_around_centre();
    else
      fill_polygons();
  }

 private:
  // Appends a polygon as a fan from its first corner; `outwards` points out of the matter.
  void add(std::vector<CornerCode> loop, const Vec3& outwards) {
    Vec3 area = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < loop.size(); ++k)
      area += (reference_corner(loop[k]) - reference_corner(loop[0]))
                  .cross(reference_corner(loop[k + 1]) - reference_corner(loop[0]));
    const bool flip = area.dot(outwards) < 0;
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      auto& corner = out_.triangles[out_.triangle_count++];
      corner = {loop[0], loop[k], loop[k + 1]};
      if (flip) std::swap(corner[1], corner[2]);
    }
  }

  static Vec3 outwards(int edge, int vertex) {
    return reference_vertex(other_end(edge, vertex)) - reference_vertex(vertex);
  }

  void fan_around_centre() {
    for (int e = 0; e < 6; ++e) {
      if (!(mask_ >> e & 1)) continue;
      for (int f : edge_faces[e]) {
        const int next = degree(mask_, f) == 2 ? partner(mask_, f, e) : -1;
        if (next >= 0 && next < e) continue;
        for (int v : edge_ends[e]) {
          const int component = all_.face_component[face_mask(mask_, f)][corner_of(f, v)];
          const int far_vertex = next >= 0 ? same_side(e, v, next) : -1;
          const CornerCode far_corner =
              next >= 0 ? middle(next, far_vertex)
                        : static_cast<CornerCode>(face_code + 3 * f + component);
          Vec3 direction = outwards(e, v);
          if (next >= 0) direction += outwards(next, far_vertex);
          const auto centre = static_cast<CornerCode>(tet_code + all_.tet_component[mask_][v]);
          add({middle(e, v), far_corner, centre}, direction);
        }
      }
    }
  }

  // Broken edges are arcs between faces; with at most two arcs a face they form paths and cycles.
  void fill_polygons() {
    int done = 0;
    for (int e = 0; e < 6; ++e) {
      if (!(mask_ >> e & 1) || (done >> e & 1)) continue;
      int edge = e, face = edge_faces[e][0];
      for (int step = 0; step < 6 && degree(mask_, face) == 2; ++step) {
        edge = partner(mask_, face, edge);
        if (edge == e) break;
        face = edge_faces[edge][edge_faces[edge][0] == face ? 1 : 0];
      }
      const bool cycle = degree(mask_, face) == 2;
      const int first = cycle ? e : edge;
      if (cycle) face = edge_faces[e][0];
      add_both_sides(first, face, cycle, done);
    }
  }

  void add_both_sides(int first, int start_face, bool cycle, int& done) {
    for (int side = 0; side < 2; ++side) {
      int edge = first, face = start_face, vertex = edge_ends[first][side];
      std::vector<CornerCode> loop;
      Vec3 direction = Vec3::Zero();
      if (!cycle) loop.push_back(static_cast<CornerCode>(face_code + 3 * face));
      while (true) {
        done |= 1 << edge;
        loop.push_back(middle(edge, vertex));
        direction += outwards(edge, vertex);
        face = edge_faces[edge][edge_faces[edge][0] == face ? 1 : 0];
        if (degree(mask_, face) != 2) break;
        const int next = partner(mask_, face, edge);
        if (next == first) break;
        vertex = same_side(edge, vertex, next);
        edge = next;
      }
      if (!cycle) loop.push_back(static_cast<CornerCode>(face_code + 3 * face));
      add(loop, direction);
    }
  }

  TetTemplates& all_;
  TetTemplate& out_;
  int mask_;
};

}  // namespace

TetTemplates::TetTemplates() {
  const auto join = [](std::uint8_t& a, std::uint8_t& b) { a = b = std::min(a, b); };
  for (int m = 0; m < 64; ++m) {
    for (int v = 0; v < 4; ++v) tet_component[m][v] = static_cast<std::uint8_t>(v);
    for (int pass = 0; pass < 4; ++pass)
      for (int e = 0; e < 6; ++e)
        if (!(m >> e & 1))
          join(tet_component[m][edge_ends[e][0]], tet_component[m][edge_ends[e][1]]);
  }
  constexpr int ends[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int m = 0; m < 8; ++m) {
    for (int v = 0; v < 3; ++v) face_component[m][v] = static_cast<std::uint8_t>(v);
    for (int pass = 0; pass < 3; ++pass)
      for (int e = 0; e < 3; ++e)
        if (!(m >> e & 1)) join(face_component[m][ends[e][0]], face_component[m][ends[e][1]]);
  }
  for (int m = 1; m < 64; ++m) Builder(*this, m);
}

const TetTemplates& tet_templates() {
  static const TetTemplates templates;
  return templates;
}

}  // namespace rend
