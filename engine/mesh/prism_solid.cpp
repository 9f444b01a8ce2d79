// A simple polygon in x-y extruded along z.
#include "engine/core/error.h"
#include "engine/mesh/solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rend {

namespace {

using Vec2 = Eigen::Vector2d;
using Outline = std::vector<Vec2>;

Real cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

Real twice_area(const Outline& p) {
  Real sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    sum += cross(p[i] - p[0], p[(i + 1) % p.size()] - p[0]);
  return sum;
}

bool contains(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& x) {
  return cross(b - a, x - a) >= 0 && cross(c - b, x - b) >= 0 && cross(a - c, x - c) >= 0;
}

// Ear clipping; O(n^2) to O(n^3), outlines are short.
std::vector<Triangle> triangulate(const Outline& p) {
  std::vector<Index> ring(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) ring[i] = Index(i);
  const auto at = [&](Index i) { return p[std::size_t(i)]; };
  std::vector<Triangle> triangles;
  while (ring.size() > 3) {
    bool clipped = false;
    for (std::size_t i = 0; i < ring.size() && !clipped; ++i) {
      const Index a = ring[(i + ring.size() - 1) % ring.size()], b = ring[i];
      const Index c = ring[(i + 1) % ring.size()];
      if (cross(at(b) - at(a), at(c) - at(b)) <= 0) continue;
      clipped = std::none_of(ring.begin(), ring.end(), [&](Index x) {
        return x != a && x != b && x != c && contains(at(a), at(b), at(c), at(x));
      });
      if (!clipped) continue;
      triangles.push_back({a, b, c});
      ring.erase(ring.begin() + std::ptrdiff_t(i));
    }
    if (!clipped) throw Error("outline", "is not a simple polygon: its edges cross or touch");
  }
  triangles.push_back({ring[0], ring[1], ring[2]});
  return triangles;
}

// Points in the middle of straight runs are not corners and would stop ear clipping.
Outline without_straight_points(const Outline& p) {
  Outline kept;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec2 before = p[i] - p[(i + p.size() - 1) % p.size()];
    const Vec2 after = p[(i + 1) % p.size()] - p[i];
    if (std::abs(cross(before, after)) > 1e-9 * before.norm() * after.norm()) kept.push_back(p[i]);
  }
  return kept;
}

class Prism final : public Solid {
 public:
  explicit Prism(const PrismDesc& prism)
      : outline_(without_straight_points(prism.outline)), half_(0.5 * prism.depth) {
    const Real area2 = outline_.size() < 3 ? 0 : twice_area(outline_);
    if (!(std::abs(area2) > 0) || !(half_ > 0)) throw Error("outline", "encloses no area");
    if (area2 < 0) std::reverse(outline_.begin(), outline_.end());
    Vec2 low = outline_[0], high = outline_[0];
    for (const Vec2& p : outline_) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const Vec2 centre = 0.5 * (low + high);
    for (Vec2& p : outline_) p -= centre;
    low -= centre;
    high -= centre;
    bounds_ = {Vec3(low.x(), low.y(), -half_), Vec3(high.x(), high.y(), half_)};
    volume_ = 0.5 * std::abs(area2) * prism.depth;
    make_surface();
  }

  Real distance(const Vec3& x) const override {
    const Vec2 p = x.head<2>();
    const Real side = (p - closest_on_outline(p)).norm();
    const Vec2 q(inside_outline(p) ? -side : side, std::abs(x.z()) - half_);
    return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
  }
  Vec3 onto_surface(const Vec3& x) const override {
    const Vec2 p = x.head<2>(), on_side = closest_on_outline(p);
    if (std::abs(std::abs(x.z()) - half_) < (p - on_side).norm())
      return {x.x(), x.y(), std::copysign(half_, x.z())};
    return {on_side.x(), on_side.y(), x.z()};
  }

 private:
  void make_surface() {
    const Index n = Index(outline_.size());
    for (int side = 0; side < 2; ++side)
      for (const Vec2& p : outline_)
        surface_.positions.emplace_back(p.x(), p.y(), side ? half_ : -half_);
    for (const Triangle& t : triangulate(outline_)) {
      surface_.triangles.push_back({t[0], t[2], t[1]});
      surface_.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    }
    const Real sharp = std::cos(crease_angle * M_PI / 180);
    std::vector<Edge> edges;
    for (Index i = 0; i < n; ++i) {
      const Index j = (i + 1) % n;
      surface_.triangles.push_back({i, j, j + n});
      surface_.triangles.push_back({i, j + n, i + n});
      edges.push_back({i, j});
      edges.push_back({i + n, j + n});
      const Vec2 before = outline_[std::size_t(i)] - outline_[std::size_t((i + n - 1) % n)];
      const Vec2 after = outline_[std::size_t(j)] - outline_[std::size_t(i)];
      // Gently turning outlines (a gear's arc in short steps) bend without an edge along z.
      if (before.normalized().dot(after.normalized()) < sharp) edges.push_back({i, i + n});
    }
    creases_ = chain_creases(surface_.positions, edges);
  }
  Vec2 closest_on_outline(const Vec2& x) const {
    Vec2 best = outline_[0];
    for (std::size_t i = 0; i < outline_.size(); ++i) {
      const Vec2 a = outline_[i], ab = outline_[(i + 1) % outline_.size()] - a;
      const Vec2 p = a + std::clamp((x - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) * ab;
      if ((x - p).squaredNorm() < (x - best).squaredNorm()) best = p;
    }
    return best;
  }
  bool inside_outline(const Vec2& x) const {
    bool in = false;
    for (std::size_t i = 0; i < outline_.size(); ++i) {
      const Vec2 &a = outline_[i], &b = outline_[(i + 1) % outline_.size()];
      if ((a.y() > x.y()) == (b.y() > x.y())) continue;
      if (x.x() < a.x() + (x.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) in = !in;
    }
    return in;
  }

  Outline outline_;
  Real half_;
};

}  // namespace

std::unique_ptr<Solid> make_prism(const PrismDesc& prism) { return std::make_unique<Prism>(prism); }

}  // namespace rend
