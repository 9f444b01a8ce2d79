// Poisson-disk samples on a surface: darts on fragments of triangles; uncovered fragments are
// halved and get further darts (White et al. 2007, carried over to surfaces).
#include "engine/core/random.h"
#include "engine/mesh/point_grid.h"
#include "engine/mesh/sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

namespace rend {

namespace {

using Fragment = std::array<Vec3, 3>;

class SurfaceSampler {
 public:
  SurfaceSampler(const Solid& solid, Real radius, Random random)
      : solid_(solid), radius_(radius), random_(random), grid_(solid.bounds(), radius) {}

  // Short loose ends of sharp edges are noise of scanned surfaces, not features.
  void add_creases() {
    std::map<Index, Real> group_length;
    for (const CreaseCurve& c : solid_.creases())
      group_length[c.group] += length_of(closed_points(c));
    std::vector<const CreaseCurve*> curves;
    for (const CreaseCurve& c : solid_.creases())
      if (group_length[c.group] > 3 * radius_) curves.push_back(&c);
    for (const CreaseCurve* c : curves)
      if (!c->closed)
        for (const Vec3& x : {c->points.front(), c->points.back()})
          if (!near(x, 0.2 * radius_)) add(x, Vec3::Zero(), SampleKind::crease);
    for (const CreaseCurve* c : curves) add_curve(*c);
  }

  // Equal steps along each curve. They are a little longer than `radius`, so that two neighbours
  // still forbid surface samples inside the ball over their edge and Delaunay keeps that edge.
  void add_curve(const CreaseCurve& curve) {
    const std::vector<Vec3> points = closed_points(curve);
    const Real length = length_of(points);
    const int steps = std::max(curve.closed ? 3 : 1, int(std::ceil(length / (1.15 * radius_))));
    std::size_t segment = 1;
    Real before = 0;
    for (int i = curve.closed ? 0 : 1; i < steps; ++i) {
      const Real s = length * i / steps;
      Real l = (points[segment] - points[segment - 1]).norm();
      while (segment + 1 < points.size() && before + l < s) {
        before += l;
        ++segment;
        l = (points[segment] - points[segment - 1]).norm();
      }
      const Vec3 chord =
          points[segment - 1] + (s - before) / l * (points[segment] - points[segment - 1]);
      const Vec3 x = solid_.onto_crease(chord);
      if (!near(x, 0.2 * radius_)) add(x, Vec3::Zero(), SampleKind::crease);
    }
  }

  void add_disk() {
    std::vector<Fragment> active;
    const TriangleSurface& s = solid_.surface();
    for (std::size_t t = 0; t < s.triangles.size(); ++t)
      split({s.corner(t, 0), s.corner(t, 1), s.corner(t, 2)}, 0.8 * radius_, active);
    for (int round = 0; round < 8 && !active.empty(); ++round) {
      for (std::size_t i = active.size(); i > 1; --i)
        std::swap(active[i - 1], active[std::size_t(random_.next() * Real(i))]);
      for (const Fragment& f : active) throw_dart(f);
      std::vector<Fragment> rest;
      for (const Fragment& f : active) {
        if (covered(f)) continue;
        const auto [a, b] = halves(f);
        if (!covered(a)) rest.push_back(a);
        if (!covered(b)) rest.push_back(b);
      }
      active.swap(rest);
    }
  }

  Samples take() { return std::move(samples_); }

 private:
  static std::vector<Vec3> closed_points(const CreaseCurve& curve) {
    std::vector<Vec3> points = curve.points;
    if (curve.closed) points.push_back(points.front());
    return points;
  }
  static Real length_of(const std::vector<Vec3>& points) {
    Real length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
    return length;
  }
  static Vec3 normal(const Fragment& f) { return (f[1] - f[0]).cross(f[2] - f[0]).normalized(); }

  void add(const Vec3& x, const Vec3& n, SampleKind kind) {
    grid_.add(x);
    samples_.add(x, kind, n);
  }
  bool near(const Vec3& x, Real r) const {
    return grid_.any_near(x, [&](Index, Real d2) { return d2 < r * r; });
  }
  // The two sides of a thin wall must not compete for samples.
  bool same_sheet(Index i, const Vec3& n) const {
    return samples_.normal[std::size_t(i)].dot(n) > -0.3;
  }

  void throw_dart(const Fragment& f) {
    Real u = random_.next(), v = random_.next();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Vec3 x = solid_.onto_surface(f[0] + u * (f[1] - f[0]) + v * (f[2] - f[0])), n = normal(f);
    const Real r2 = radius_ * radius_;
    if (!grid_.any_near(
            x, [&](Index i, Real d2) { return d2 < r2 && (same_sheet(i, n) || d2 < 0.09 * r2); }))
      add(x, n, SampleKind::surface);
  }
  bool covered(const Fragment& f) const {
    const Vec3 middle = (f[0] + f[1] + f[2]) / 3, n = normal(f);
    const Real r2 = radius_ * radius_;
    return grid_.any_near(middle, [&](Index i, Real) {
      const Vec3& p = grid_.points()[std::size_t(i)];
      return same_sheet(i, n) && (f[0] - p).squaredNorm() < r2 && (f[1] - p).squaredNorm() < r2 &&
             (f[2] - p).squaredNorm() < r2;
    });
  }

  static int longest(const Fragment& f) {
    const Real l[3] = {(f[1] - f[0]).squaredNorm(), (f[2] - f[1]).squaredNorm(),
                       (f[0] - f[2]).squaredNorm()};
    return int(std::max_element(l, l + 3) - l);
  }
  std::pair<Fragment, Fragment> halves(const Fragment& f) const {
    const int k = longest(f);
    const Vec3 &a = f[std::size_t(k)], &b = f[std::size_t((k + 1) % 3)],
               &c = f[std::size_t((k + 2) % 3)];
    const Vec3 m = solid_.onto_surface(0.5 * (a + b));
    return {{a, m, c}, {m, b, c}};
  }
  void split(const Fragment& f, Real limit, std::vector<Fragment>& out) const {
    std::vector<Fragment> stack = {f};
    while (!stack.empty()) {
      const Fragment top = stack.back();
      stack.pop_back();
      const int k = longest(top);
      if ((top[std::size_t((k + 1) % 3)] - top[std::size_t(k)]).norm() <= limit) {
        out.push_back(top);
        continue;
      }
      const auto [a, b] = halves(top);
      stack.push_back(b);
      stack.push_back(a);
    }
  }

  const Solid& solid_;
  Real radius_;
  Random random_;
  PointGrid grid_;
  Samples samples_;
};

}  // namespace

Samples sample_surface(const Solid& solid, Real radius, std::uint64_t seed, std::uint64_t stream) {
  SurfaceSampler sampler(solid, radius, Random(seed, 4 * stream + 1));
  sampler.add_creases();
  sampler.add_disk();
  return sampler.take();
}

}  // namespace rend
