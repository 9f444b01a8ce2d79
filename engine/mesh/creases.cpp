// Finds sharp edges and walks along them.
#include "engine/mesh/creases.h"

#include "engine/mesh/edge_uses.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace rend {

namespace {

const Real sharp_cosine = std::cos(crease_angle * std::numbers::pi / 180);

class Chainer {
 public:
  Chainer(const std::vector<Vec3>& positions, const std::vector<Edge>& edges)
      : positions_(positions), edges_(edges), done_(edges.size(), 0) {
    for (std::size_t e = 0; e < edges.size(); ++e)
      for (Index v : edges[e]) at_[v].push_back(e);
  }

  std::vector<CreaseCurve> run() {
    for (const auto& [v, list] : at_)
      if (is_corner(v))
        for (std::size_t e : list) walk(v, e);
    for (std::size_t e = 0; e < edges_.size(); ++e) walk(edges_[e][0], e);
    number_groups();
    return std::move(curves_);
  }

 private:
  const Vec3& x(Index v) const { return positions_[std::size_t(v)]; }
  Index other(std::size_t e, Index v) const {
    return edges_[e][0] == v ? edges_[e][1] : edges_[e][0];
  }
  bool is_corner(Index v) const {
    const auto& list = at_.at(v);
    if (list.size() != 2) return true;
    const Vec3 in = x(v) - x(other(list[0], v)), out = x(other(list[1], v)) - x(v);
    return in.dot(out) < sharp_cosine * in.norm() * out.norm();
  }
  void walk(Index from, std::size_t e) {
    if (done_[e]) return;
    CreaseCurve curve;
    curve.points.push_back(x(from));
    Index v = from;
    for (;;) {
      done_[e] = 1;
      v = other(e, v);
      if (v == from && !is_corner(from)) {
        curve.closed = true;
        break;
      }
      curve.points.push_back(x(v));
      if (is_corner(v)) break;
      const auto& list = at_.at(v);
      e = list[0] == e ? list[1] : list[0];
    }
    curves_.push_back(curve);
    ends_.push_back({from, v});
  }
  void number_groups() {
    std::map<Index, Index> root;
    const auto find = [&](Index v) {
      while (root.count(v) && root[v] != v) v = root[v];
      return v;
    };
    for (const Edge& e : ends_) {
      const Index a = find(e[0]), b = find(e[1]);
      root[std::max(a, b)] = std::min(a, b);
    }
    for (std::size_t c = 0; c < curves_.size(); ++c) curves_[c].group = find(ends_[c][0]);
  }

  const std::vector<Vec3>& positions_;
  const std::vector<Edge>& edges_;
  std::vector<char> done_;
  std::map<Index, std::vector<std::size_t>> at_;
  std::vector<CreaseCurve> curves_;
  std::vector<Edge> ends_;
};

}  // namespace

std::vector<CreaseCurve> chain_creases(const std::vector<Vec3>& positions,
                                       const std::vector<Edge>& edges) {
  return Chainer(positions, edges).run();
}

std::vector<Edge> sharp_edges(const TriangleSurface& surface) {
  std::vector<Vec3> normals;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Vec3 a = surface.corner(t, 0);
    const Vec3 n = (surface.corner(t, 1) - a).cross(surface.corner(t, 2) - a);
    const Real longest = std::max({(surface.corner(t, 1) - a).squaredNorm(),
                                   (surface.corner(t, 2) - a).squaredNorm(),
                                   (surface.corner(t, 2) - surface.corner(t, 1)).squaredNorm()});
    // Needles have no direction worth trusting.
    normals.push_back(n.norm() > 1e-6 * longest ? Vec3(n.normalized()) : Vec3::Zero());
  }
  std::vector<Edge> edges;
  for_each_edge(edge_uses(surface.triangles), [&](std::span<const EdgeUse> uses) {
    if (uses.size() != 2) return;
    const Vec3 &n = normals[std::size_t(uses[0].triangle)],
               &m = normals[std::size_t(uses[1].triangle)];
    if (!n.isZero() && !m.isZero() && n.dot(m) < sharp_cosine) edges.push_back(uses[0].edge);
  });
  return edges;
}

}  // namespace rend
