// Tells whether a surface is what a fracture mesh must be: closed, oriented, a 2-manifold, with
// matter inside.
#pragma once

#include "engine/fracture/surface_mesh.h"

#include <string>
#include <vector>

namespace rend {

/// What is wrong with a surface; every count is 0 for a good one.
struct MeshCheck {
  Index open_edges = 0;  ///< directed edges without exactly one opposite
  Index repeated_edges =
      0;  ///< directed edges used more than once: orientation or manifoldness is broken
  Index split_links = 0;  ///< vertices whose triangles do not form one cycle
  Index degenerate = 0;   ///< triangles that repeat a vertex or use one that does not exist
  Index unused_vertices = 0;
  Index inside_out = 0;      ///< pieces with no positive volume
  Index not_finite = 0;      ///< vertices with a NaN or infinite coordinate
  std::vector<Index> piece;  ///< ids of the pieces, ascending
  std::vector<Real> volume;  ///< signed volume of each piece [m3]

  bool good() const {
    return !(open_edges || repeated_edges || split_links || degenerate || unused_vertices ||
             inside_out || not_finite);
  }
  std::string text() const;  ///< one line for a log or a test message
};

/// O(#T log #T). A mesh without `piece` counts as one piece.
MeshCheck check_mesh(const SurfaceMesh& mesh);

}  // namespace rend
