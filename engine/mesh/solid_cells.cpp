// Blocks of cells are settled by one distance each; only blocks near the surface are split.
#include "engine/mesh/solid_cells.h"

#include "engine/core/parallel.h"

namespace rend {

namespace {
constexpr int block_side = 8;
}

SolidCells::SolidCells(const Solid& solid, Real side, Real depth)
    : solid_(solid),
      depth_(depth),
      lattice_(solid.bounds(), side),
      state_(lattice_.count(), mixed) {
  const Vec3i blocks = (lattice_.size.array() + block_side - 1) / block_side;
  parallel_for(Index(blocks.prod()), 4, [&](Index b) {
    const Vec3i block(b % blocks.x(), b / blocks.x() % blocks.y(), b / (blocks.x() * blocks.y()));
    classify(block * block_side, block_side);
  });
}

void SolidCells::classify(const Vec3i& low, int block) {
  if ((low.array() >= lattice_.size.array()).any()) return;
  const Real half_diagonal = 0.5 * std::sqrt(3.0) * block * lattice_.side;
  const Vec3 centre = lattice_.corner(low) + Vec3::Constant(0.5 * block * lattice_.side);
  const Real clearance = solid_.clearance(centre, 1.001 * (half_diagonal + depth_));
  const bool is_in = clearance > half_diagonal && solid_.inside(centre);
  const bool is_out = clearance > half_diagonal && !is_in;
  if (is_out || (is_in && clearance > half_diagonal + depth_)) {
    const Vec3i high = (low.array() + block).min(lattice_.size.array());
    for (int z = low.z(); z < high.z(); ++z)
      for (int y = low.y(); y < high.y(); ++y)
        for (int x = low.x(); x < high.x(); ++x)
          state_[lattice_.index({x, y, z})] = is_in ? deep : outside;
  } else if (block > 1) {
    const int h = block / 2;
    for (int c = 0; c < 8; ++c)
      classify(low + Vec3i(c & 1 ? h : 0, c & 2 ? h : 0, c & 4 ? h : 0), h);
  }
}

bool SolidCells::inside(const Vec3& x) const {
  const State s = state(lattice_.cell_of(x));
  return s == deep || (s == mixed && solid_.inside(x));
}

bool SolidCells::touches_depth(const Vec3& centre, Real side) const {
  const Real limit = 0.5 * std::sqrt(3.0) * side - depth_;
  const Real clearance = solid_.clearance(centre, 1.001 * std::abs(limit));
  if (limit > 0) return clearance < limit || solid_.inside(centre);
  return clearance > -limit && solid_.inside(centre);
}

bool SolidCells::is_deep(const Vec3& x) const {
  const State s = state(lattice_.cell_of(x));
  return s == deep ||
         (s == mixed && solid_.clearance(x, 1.001 * depth_) > depth_ && solid_.inside(x));
}

}  // namespace rend
