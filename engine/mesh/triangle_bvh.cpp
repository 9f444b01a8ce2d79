// Median splits, depth-first queries with the nearer child first.
#include "engine/mesh/triangle_bvh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rend {

namespace {

constexpr Index leaf_size = 4;

Real squared_distance(const Bounds& b, const Vec3& x) {
  return (b.low - x).cwiseMax(x - b.high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

Vec3 closest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const Real d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bx = x - b;
  const Real d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return b;
  const Vec3 cx = x - c;
  const Real d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return c;
  const Real vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
  const Real sum = va + vb + vc;
  return sum > 0 ? Vec3(a + vb / sum * ab + vc / sum * ac) : a;
}

Real solid_angle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 p = a - x, q = b - x, r = c - x;
  const Real lp = p.norm(), lq = q.norm(), lr = r.norm();
  return 2 * std::atan2(p.dot(q.cross(r)),
                        lp * lq * lr + p.dot(q) * lr + q.dot(r) * lp + r.dot(p) * lq);
}

TriangleBvh::TriangleBvh(const TriangleSurface& surface)
    : surface_(surface), order_(surface.triangles.size()) {
  std::vector<Vec3> centroids(order_.size());
  for (std::size_t t = 0; t < order_.size(); ++t) {
    order_[t] = Index(t);
    centroids[t] = (surface.corner(t, 0) + surface.corner(t, 1) + surface.corner(t, 2)) / 3;
  }
  nodes_.reserve(2 * order_.size() / leaf_size + 16);
  nodes_.emplace_back();
  nodes_[0].count = Index(order_.size());
  build(0, centroids);
}

void TriangleBvh::build(Index n, std::vector<Vec3>& centroids) {
  Node node = nodes_[std::size_t(n)];
  const auto begin = order_.begin() + node.first, end = begin + node.count;
  Bounds middle;
  Real area = 0;
  for (auto t = begin; t != end; ++t) {
    const auto i = std::size_t(*t);
    const Vec3 a = surface_.corner(i, 0), b = surface_.corner(i, 1), c = surface_.corner(i, 2);
    for (const Vec3& x : {a, b, c}) node.box.add(x);
    middle.add(centroids[i]);
    const Vec3 twice = (b - a).cross(c - a);
    node.dipole += 0.5 * twice;
    node.centre += 0.5 * twice.norm() * centroids[i];
    area += 0.5 * twice.norm();
  }
  node.centre = area > 0 ? Vec3(node.centre / area) : node.box.centre();
  for (auto t = begin; t != end; ++t)
    for (int k = 0; k < 3; ++k)
      node.radius =
          std::max(node.radius, (surface_.corner(std::size_t(*t), k) - node.centre).norm());
  if (node.count > leaf_size) {
    int axis = 0;
    middle.size().maxCoeff(&axis);
    const auto half = begin + node.count / 2;
    std::nth_element(begin, half, end, [&](Index s, Index t) {
      const Real x = centroids[std::size_t(s)][axis], y = centroids[std::size_t(t)][axis];
      return x < y || (x == y && s < t);
    });
    node.left = Index(nodes_.size());
    Node left, right;
    left.first = node.first;
    left.count = node.count / 2;
    right.first = node.first + left.count;
    right.count = node.count - left.count;
    nodes_.push_back(left);
    nodes_.push_back(right);
  }
  nodes_[std::size_t(n)] = node;
  if (node.left >= 0) {
    build(node.left, centroids);
    build(node.left + 1, centroids);
  }
}

Real TriangleBvh::distance(const Vec3& x, Real limit) const {
  Real best = limit * limit;
  Index stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[std::size_t(stack[--depth])];
    if (squared_distance(node.box, x) >= best) continue;
    if (node.left < 0) {
      for (Index i = node.first; i < node.first + node.count; ++i) {
        const auto t = std::size_t(order_[std::size_t(i)]);
        const Vec3 p = closest_on_triangle(x, surface_.corner(t, 0), surface_.corner(t, 1),
                                           surface_.corner(t, 2));
        best = std::min(best, (p - x).squaredNorm());
      }
      continue;
    }
    const bool left_first = squared_distance(nodes_[std::size_t(node.left)].box, x) <=
                            squared_distance(nodes_[std::size_t(node.left + 1)].box, x);
    stack[depth++] = node.left + (left_first ? 1 : 0);
    stack[depth++] = node.left + (left_first ? 0 : 1);
  }
  return std::sqrt(best);
}

Real TriangleBvh::winding_number(const Vec3& x) const {
  Real angle = 0;
  Index stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[std::size_t(stack[--depth])];
    const Vec3 to = node.centre - x;
    const Real d2 = to.squaredNorm();
    if (d2 > 4 * node.radius * node.radius && d2 > 0) {
      angle += node.dipole.dot(to) / (d2 * std::sqrt(d2));
    } else if (node.left < 0) {
      for (Index i = node.first; i < node.first + node.count; ++i) {
        const auto t = std::size_t(order_[std::size_t(i)]);
        angle +=
            solid_angle(x, surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2));
      }
    } else {
      stack[depth++] = node.left;
      stack[depth++] = node.left + 1;
    }
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace rend
