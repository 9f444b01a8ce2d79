// A solid bounded by a closed triangle surface.
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mesh/solid.h"
#include "engine/mesh/solid_cells.h"
#include "engine/mesh/triangle_bvh.h"

#include <cmath>

namespace rend {

namespace {

class MeshSolid final : public Solid {
 public:
  MeshSolid(TriangleSurface surface, Real height) {
    surface_ = std::move(surface);
    const Bounds b = bounds_of(surface_.positions);
    if (!(b.size().y() > 0)) throw Error("file", "has no extent along y to scale to the height");
    const Real scale = height / b.size().y();
    for (Vec3& x : surface_.positions) x = scale * (x - b.centre());
    bounds_ = bounds_of(surface_.positions);
    creases_ = chain_creases(surface_.positions, sharp_edges(surface_));
    bvh_ = std::make_unique<TriangleBvh>(surface_);
    // The divergence theorem counts overlapping parts twice; a count of points shows whether there
    // are any.
    const Real counted = counted_volume(64);
    volume_ = enclosed_volume(surface_);
    if (std::abs(counted - volume_) > 0.05 * volume_) volume_ = counted_volume(128);
    const Real least = 1e-7 * bounds_.size().prod();
    if (!(volume_ > least)) throw Error("file", "is not a solid: its surface encloses no volume");
  }
  Real distance(const Vec3& x) const override {
    const Real d = clearance(x, 1e150);
    return inside(x) ? -d : d;
  }
  Real clearance(const Vec3& x, Real limit) const override { return bvh_->distance(x, limit); }
  bool inside(const Vec3& x) const override { return bvh_->winding_number(x) > 0.5; }
  Vec3 onto_surface(const Vec3& x) const override { return x; }

 private:
  // Midpoint rule on cells of 1/n of the longest extent.
  Real counted_volume(int n) const {
    const Real side = bounds_.size().maxCoeff() / n;
    const SolidCells cells(*this, side, 0);
    const CellLattice& lattice = cells.lattice();
    const auto inside_in_row = [&](Index row) {
      Real count = 0;
      for (int x = 0; x < lattice.size.x(); ++x) {
        const Vec3i c(x, row % lattice.size.y(), row / lattice.size.y());
        count += cells.inside(lattice.corner(c) + Vec3::Constant(0.5 * side));
      }
      return count;
    };
    return std::pow(side, 3) *
           ordered_sum(Index(lattice.size.y() * lattice.size.z()), 16, Real(0), inside_in_row);
  }

  std::unique_ptr<TriangleBvh> bvh_;
};

}  // namespace

std::unique_ptr<Solid> make_mesh_solid(TriangleSurface surface, Real height) {
  return std::make_unique<MeshSolid>(std::move(surface), height);
}

}  // namespace rend
