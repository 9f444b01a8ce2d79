// A solid bounded by a closed triangle surface.
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mesh/solid.h"
#include "engine/mesh/triangle_bvh.h"

#include <algorithm>
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
    // The divergence theorem counts parts that lie in each other twice.
    volume_ = enclosed_volume(surface_);
    if (doubled_volume(32) > 0) volume_ -= doubled_volume(64);
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
  // What the surface goes round more than once, by the midpoint rule on n cells along each axis.
  Real doubled_volume(int n) const {
    const Vec3 side = bounds_.size() / n;
    const auto in_row = [&](Index row) {
      Real excess = 0;
      for (int x = 0; x < n; ++x) {
        const Vec3 c(x + 0.5, row % n + 0.5, row / n + 0.5);
        const Real turns = bvh_->winding_number(bounds_.low + Vec3(side.cwiseProduct(c)));
        excess += std::max(std::round(turns) - 1, Real(0));
      }
      return excess;
    };
    return side.prod() * ordered_sum(Index(n * n), 16, Real(0), in_row);
  }

  std::unique_ptr<TriangleBvh> bvh_;
};

}  // namespace

std::unique_ptr<Solid> make_mesh_solid(TriangleSurface surface, Real height) {
  return std::make_unique<MeshSolid>(std::move(surface), height);
}

}  // namespace rend
