// Sorting directed edges and walking vertex links; no hashing, so reports are reproducible.
#include "engine/fracture/check_mesh.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>

namespace rend {

namespace {

struct DirectedEdge {
  Index from, to;
  bool operator<(const DirectedEdge& o) const { return from != o.from ? from < o.from : to < o.to; }
  bool operator==(const DirectedEdge& o) const = default;
};

// Counts vertices whose opposite edges (next corner -> last corner of each triangle) are not one
// closed chain.
Index count_split_links(const std::vector<Triangle>& triangles, Index vertex_count) {
  std::vector<Index> row(vertex_count + 1, 0);
  for (const Triangle& t : triangles)
    for (Index v : t) ++row[v + 1];
  for (Index v = 0; v < vertex_count; ++v) row[v + 1] += row[v];
  std::vector<DirectedEdge> link(3 * triangles.size());
  std::vector<Index> cursor(row.begin(), row.end() - 1);
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) link[cursor[t[k]]++] = {t[(k + 1) % 3], t[(k + 2) % 3]};
  Index bad = 0;
  for (Index v = 0; v < vertex_count; ++v) {
    const auto begin = link.begin() + row[v], end = link.begin() + row[v + 1];
    if (begin == end) continue;
    std::sort(begin, end);
    auto at = begin;
    auto steps = end - begin;
    bool good = true;
    for (; steps > 0 && good; --steps) {
      const auto next = std::lower_bound(begin, end, DirectedEdge{at->to, -1});
      good = next != end && next->from == at->to && (next + 1 == end || (next + 1)->from != at->to);
      if (good && next == begin && steps > 1) good = false;
      if (good) at = next;
    }
    bad += !(good && at == begin);
  }
  return bad;
}

}  // namespace

std::string MeshCheck::text() const {
  return fmt::format(
      "open edges {}, repeated edges {}, split links {}, degenerate {}, unused vertices {}, pieces "
      "{}, inside out {}, "
      "not finite {}",
      open_edges, repeated_edges, split_links, degenerate, unused_vertices, piece.size(),
      inside_out, not_finite);
}

MeshCheck check_mesh(const SurfaceMesh& mesh) {
  MeshCheck check;
  const Index vertices = mesh.vertex_count();
  std::vector<Triangle> valid;
  valid.reserve(mesh.triangles.size());
  std::vector<std::uint8_t> used(mesh.x.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    const bool in_range = *std::min_element(t.begin(), t.end()) >= 0 &&
                          *std::max_element(t.begin(), t.end()) < vertices;
    if (!in_range || t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      ++check.degenerate;
      continue;
    }
    valid.push_back(t);
    for (Index v : t) used[v] = 1;
  }
  check.unused_vertices = static_cast<Index>(std::count(used.begin(), used.end(), 0));
  for (const Vec3& x : mesh.x) check.not_finite += !x.allFinite();

  std::vector<DirectedEdge> forward, backward;
  forward.reserve(3 * valid.size());
  backward.reserve(3 * valid.size());
  for (const Triangle& t : valid)
    for (int k = 0; k < 3; ++k) {
      forward.push_back({t[k], t[(k + 1) % 3]});
      backward.push_back({t[(k + 1) % 3], t[k]});
    }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  for (std::size_t i = 1; i < forward.size(); ++i)
    check.repeated_edges += forward[i] == forward[i - 1];
  std::vector<DirectedEdge> lonely;
  std::set_symmetric_difference(forward.begin(), forward.end(), backward.begin(), backward.end(),
                                std::back_inserter(lonely));
  check.open_edges = static_cast<Index>(lonely.size() / 2);
  check.split_links = count_split_links(valid, vertices);

  check.piece.assign(mesh.piece.begin(), mesh.piece.end());
  if (check.piece.empty() && !mesh.triangles.empty()) check.piece.push_back(0);
  std::sort(check.piece.begin(), check.piece.end());
  check.piece.erase(std::unique(check.piece.begin(), check.piece.end()), check.piece.end());
  check.volume.assign(check.piece.size(), 0);
  // A corner of each piece as origin keeps the sums exact far away from the world origin.
  std::vector<Vec3> origin(check.piece.size(), Vec3::Constant(NAN));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (*std::min_element(t.begin(), t.end()) < 0 ||
        *std::max_element(t.begin(), t.end()) >= vertices)
      continue;
    const Index id = i < mesh.piece.size() ? mesh.piece[i] : check.piece.front();
    const auto p =
        std::lower_bound(check.piece.begin(), check.piece.end(), id) - check.piece.begin();
    if (origin[p].hasNaN()) origin[p] = mesh.x[t[0]];
    const Vec3 a = mesh.x[t[0]] - origin[p], b = mesh.x[t[1]] - origin[p],
               c = mesh.x[t[2]] - origin[p];
    check.volume[p] += a.dot(b.cross(c)) / 6;
  }
  for (Real v : check.volume) check.inside_out += !(v > 0);
  return check;
}

}  // namespace rend
