// Which particles hang together through unbroken edges, with names that stay the same over time.
#pragma once

#include "engine/fracture/crack_mesh.h"

#include <vector>

namespace rend {

/// Components through unbroken edges. When a piece falls apart its largest part keeps the id (the
/// one with the lowest particle when equal); the others get new ids in the order of their lowest
/// particles.
class Pieces {
 public:
  explicit Pieces(const TetTables& tables);
  /// O(#E) union-find; call when edges broke.
  void update(const CrackMesh& crack);
  Index count() const { return count_; }
  Index of(Index particle) const { return id_[particle]; }
  /// Particles of every piece by its id, 0 for ids that are gone. O(#P).
  std::vector<Index> sizes() const;

 private:
  std::vector<Index> id_;    ///< #P
  std::vector<Index> root_;  ///< #P, scratch
  Index count_ = 0;
  Index next_id_ = 0;
};

}  // namespace rend
