// Which cells of a lattice lie inside a solid, outside, or across its surface.
#pragma once

#include "engine/mesh/point_grid.h"
#include "engine/mesh/solid.h"

#include <cstdint>

namespace rend {

/// Answers inside and depth questions without asking the solid, except near its surface.
class SolidCells {
 public:
  /// Cells of side `side`; a cell is deep when it lies deeper than `depth` everywhere. Costs one
  /// distance per cell near the surface only.
  SolidCells(const Solid& solid, Real side, Real depth);

  enum State : std::uint8_t { outside, mixed, deep };
  const CellLattice& lattice() const { return lattice_; }
  State state(const Vec3i& cell) const { return State(state_[lattice_.index(cell)]); }

  bool inside(const Vec3& x) const;
  /// At least `depth` below the surface.
  bool is_deep(const Vec3& x) const;
  /// False when no point of the cube of this side around `centre` is `depth` below the surface.
  bool touches_depth(const Vec3& centre, Real side) const;

 private:
  void classify(const Vec3i& low, int block);

  const Solid& solid_;
  Real depth_;
  CellLattice lattice_;
  std::vector<std::uint8_t> state_;
};

}  // namespace rend
