// Solids with exact distances: box, sphere, cylinder and torus.
#include "engine/mesh/solid.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace rend {

using std::numbers::pi;

Real Solid::clearance(const Vec3& x, Real) const { return std::abs(distance(x)); }

namespace {

using PointOf = std::function<Vec3(Real u, Real v)>;

// Closed in v always and in u for a torus, as rows of quads split in two.
TriangleSurface revolve(int rows, int columns, bool closed_rows, const PointOf& point) {
  TriangleSurface s;
  const int row_count = closed_rows ? rows : rows + 1;
  for (int i = 0; i < row_count; ++i)
    for (int j = 0; j < columns; ++j)
      s.positions.push_back(point(Real(i) / rows, Real(j) / columns));
  const auto at = [&](int i, int j) { return Index((i % row_count) * columns + j % columns); };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      s.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      s.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return s;
}

class Box final : public Solid {
 public:
  explicit Box(const BoxDesc& box) : half_(0.5 * box.size) {
    volume_ = box.size.prod();
    bounds_ = {-half_, half_};
    for (int c = 0; c < 8; ++c)
      surface_.positions.push_back(
          half_.cwiseProduct(Vec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1)));
    const std::array<std::array<Index, 4>, 6> quads = {
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (const auto& q : quads) {
      surface_.triangles.push_back({q[0], q[1], q[2]});
      surface_.triangles.push_back({q[0], q[2], q[3]});
    }
    std::vector<Edge> edges;
    for (Index c = 0; c < 8; ++c)
      for (int axis = 0; axis < 3; ++axis)
        if (!(c >> axis & 1)) edges.push_back({c, c | 1 << axis});
    creases_ = chain_creases(surface_.positions, edges);
  }
  Real distance(const Vec3& x) const override {
    const Vec3 q = x.cwiseAbs() - half_;
    return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
  }
  // Snapped to the face's plane, so that all samples of a face are coplanar to the last bit.
  Vec3 onto_surface(const Vec3& x) const override {
    Vec3 y = x.cwiseMax(-half_).cwiseMin(half_);
    int axis = 0;
    (y.cwiseAbs() - half_).maxCoeff(&axis);
    y[axis] = std::copysign(half_[axis], y[axis]);
    return y;
  }

 private:
  Vec3 half_;
};

class Sphere final : public Solid {
 public:
  explicit Sphere(const SphereDesc& sphere) : r_(sphere.radius) {
    volume_ = 4 * pi / 3 * r_ * r_ * r_;
    bounds_ = {Vec3::Constant(-r_), Vec3::Constant(r_)};
    surface_.positions = {{r_, 0, 0},  {-r_, 0, 0}, {0, r_, 0},
                          {0, -r_, 0}, {0, 0, r_},  {0, 0, -r_}};
    surface_.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                          {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  }
  Real distance(const Vec3& x) const override { return x.norm() - r_; }
  Vec3 onto_surface(const Vec3& x) const override {
    const Real l = x.norm();
    return l > 0 ? Vec3(r_ / l * x) : Vec3(r_, 0, 0);
  }

 private:
  Real r_;
};

class Cylinder final : public Solid {
 public:
  explicit Cylinder(const CylinderDesc& c) : r_(c.radius), half_(0.5 * c.height) {
    volume_ = pi * r_ * r_ * c.height;
    bounds_ = {Vec3(-r_, -half_, -r_), Vec3(r_, half_, r_)};
    const int n = 64;
    const auto rim = [&](Real v, Real y) {
      return Vec3(r_ * std::sin(2 * pi * v), y, r_ * std::cos(2 * pi * v));
    };
    surface_ = revolve(1, n, false, [&](Real u, Real v) { return rim(v, half_ * (1 - 2 * u)); });
    for (int side = 0; side < 2; ++side) {
      CreaseCurve circle;
      circle.closed = true;
      const Index centre = Index(surface_.positions.size());
      surface_.positions.emplace_back(0, side ? -half_ : half_, 0);
      for (int j = 0; j < n; ++j) {
        const Index a = Index(side * n + j), b = Index(side * n + (j + 1) % n);
        circle.points.push_back(surface_.positions[std::size_t(a)]);
        surface_.triangles.push_back(side ? Triangle{centre, b, a} : Triangle{centre, a, b});
      }
      circle.group = side;
      creases_.push_back(circle);
    }
  }
  Real distance(const Vec3& x) const override {
    const Eigen::Vector2d q(std::hypot(x.x(), x.z()) - r_, std::abs(x.y()) - half_);
    return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
  }
  Vec3 onto_surface(const Vec3& x) const override {
    const Real rho = std::hypot(x.x(), x.z());
    if (std::abs(std::abs(x.y()) - half_) < std::abs(rho - r_))
      return {x.x(), std::copysign(half_, x.y()), x.z()};
    return {x.x() * r_ / rho, x.y(), x.z() * r_ / rho};
  }
  Vec3 onto_crease(const Vec3& x) const override {
    const Real rho = std::hypot(x.x(), x.z());
    return {x.x() * r_ / rho, std::copysign(half_, x.y()), x.z() * r_ / rho};
  }

 private:
  Real r_, half_;
};

class Torus final : public Solid {
 public:
  explicit Torus(const TorusDesc& t) : major_(t.major_radius), minor_(t.minor_radius) {
    volume_ = 2 * pi * pi * major_ * minor_ * minor_;
    const Real outer = major_ + minor_;
    bounds_ = {Vec3(-outer, -minor_, -outer), Vec3(outer, minor_, outer)};
    surface_ = revolve(24, 64, true, [&](Real u, Real v) {
      const Real q = major_ + minor_ * std::cos(2 * pi * u);
      return Vec3(q * std::cos(2 * pi * v), minor_ * std::sin(2 * pi * u),
                  q * std::sin(2 * pi * v));
    });
  }
  Real distance(const Vec3& x) const override {
    return std::hypot(std::hypot(x.x(), x.z()) - major_, x.y()) - minor_;
  }
  Vec3 onto_surface(const Vec3& x) const override {
    const Real rho = std::hypot(x.x(), x.z());
    const Vec3 ring(x.x() * major_ / rho, 0, x.z() * major_ / rho);
    return ring + minor_ * (x - ring).normalized();
  }

 private:
  Real major_, minor_;
};

}  // namespace

std::unique_ptr<Solid> make_box(const BoxDesc& box) { return std::make_unique<Box>(box); }
std::unique_ptr<Solid> make_sphere(const SphereDesc& s) { return std::make_unique<Sphere>(s); }
std::unique_ptr<Solid> make_cylinder(const CylinderDesc& c) {
  return std::make_unique<Cylinder>(c);
}
std::unique_ptr<Solid> make_torus(const TorusDesc& torus) { return std::make_unique<Torus>(torus); }

}  // namespace rend
