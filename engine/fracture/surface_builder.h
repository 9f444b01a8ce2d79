// Positions, fields and normals of one frame, laid over the cut topology.
#pragma once

#include "engine/fracture/crack_mesh.h"
#include "engine/fracture/pieces.h"
#include "engine/fracture/rotation_field.h"
#include "engine/fracture/surface_mesh.h"
#include "engine/mpm/snapshot.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace rend {

/// CPU time of the three sweeps [s].
struct SurfaceTimes {
  Real positions = 0, triangles = 0, normals = 0;
};

/// Memory of the sweeps between frames: at a million particles the system needs longer to give
/// fresh memory than the sweeps to fill it.
class SurfaceScratch {
 public:
  SurfaceScratch();
  ~SurfaceScratch();
  std::size_t bytes() const;

 private:
  friend class SurfaceBuilder;
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

/// A copy lies at the mean of x_a + R_a (X - X_a) over its members a, a crack tip at the barycentre
/// of its face, a skin vertex at its particle; damage, stress, speed and `nearness` (#P, or empty)
/// are means over members. Crack tips and cuts open continuously from zero. Pieces of fewer than
/// `smallest_piece` particles are left out, but for the largest. Fills `surface`, reusing its
/// memory and that of `scratch`. O(#V + #T).
void build_surface(const CrackMesh& crack, const Pieces& pieces, const RotationField& rotations,
                   const std::vector<std::uint8_t>& crease, const Snapshot& snapshot,
                   const std::vector<float>& nearness, Index smallest_piece, SurfaceMesh& surface,
                   SurfaceScratch& scratch, SurfaceTimes* times = nullptr);

}  // namespace rend
