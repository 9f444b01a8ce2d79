// Points in cubic cells, for "is anything nearer than r" in constant time.
#pragma once

#include "engine/mesh/triangle_surface.h"

#include <cmath>
#include <vector>

namespace rend {

/// A box of cubic cells.
struct CellLattice {
  Vec3 origin = Vec3::Zero();
  Real side = 1;  ///< [m]
  Vec3i size = Vec3i::Zero();

  CellLattice() = default;
  /// Covers `bounds` with a margin of one cell all round.
  CellLattice(const Bounds& bounds, Real cell_side)
      : origin(bounds.low - Vec3::Constant(cell_side)),
        side(cell_side),
        size((bounds.size() / cell_side).array().ceil().cast<int>() + 2) {}

  std::size_t count() const {
    return std::size_t(size.x()) * std::size_t(size.y()) * std::size_t(size.z());
  }
  Vec3i cell_of(const Vec3& x) const {
    return ((x - origin) / side).array().floor().cast<int>().max(0).min(size.array() - 1);
  }
  std::size_t index(const Vec3i& c) const {
    return (std::size_t(c.z()) * std::size_t(size.y()) + std::size_t(c.y())) *
               std::size_t(size.x()) +
           std::size_t(c.x());
  }
  Vec3 corner(const Vec3i& c) const { return origin + side * c.cast<Real>(); }
};

/// Growing set of points; queries up to one cell side.
class PointGrid {
 public:
  PointGrid(const Bounds& bounds, Real radius)
      : lattice_(bounds, radius), first_(lattice_.count(), -1) {}

  void add(const Vec3& x) {
    Index& head = first_[lattice_.index(lattice_.cell_of(x))];
    next_.push_back(head);
    head = Index(points_.size());
    points_.push_back(x);
  }

  /// True when test(i, squared distance) holds for any point in the 27 cells around x.
  template <class Test>
  bool any_near(const Vec3& x, Test&& test) const {
    const Vec3i c = lattice_.cell_of(x);
    const Vec3i low = (c.array() - 1).max(0), high = (c.array() + 1).min(lattice_.size.array() - 1);
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y) {
        const std::size_t row = lattice_.index({0, y, z});
        for (int i = low.x(); i <= high.x(); ++i)
          for (Index p = first_[row + std::size_t(i)]; p >= 0; p = next_[std::size_t(p)])
            if (test(p, (points_[std::size_t(p)] - x).squaredNorm())) return true;
      }
    return false;
  }

  const std::vector<Vec3>& points() const { return points_; }

 private:
  CellLattice lattice_;
  std::vector<Index> first_;
  std::vector<Index> next_;
  std::vector<Vec3> points_;
};

}  // namespace rend
