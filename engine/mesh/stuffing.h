// Quality tets for bodies with mesh forces: a lattice stuffed into the solid.
#pragma once

#include "engine/mesh/body.h"

namespace rend {

/// Body-centred cubic lattice fitted to the bounding box, lattice points near the surface moved
/// onto it, and lattice tets cut at it: isosurface stuffing (Labelle and Shewchuk 2007) with a
/// uniform lattice; quads are split from their lowest vertex (Dompierre et al. 1999). Faces of the
/// bounding box that the solid fills come out flat, other sharp edges are rounded off by up to a
/// cell. The number of vertices is within 10 % of `count` for bodies of some hundred. @throws Error
/// when no tet is left.
Body stuff_body(const Solid& solid, Real count);

/// Least altitude of a tet [m] and least dihedral angle [rad].
struct TetQuality {
  Real altitude = 0;
  Real dihedral = 0;
};
TetQuality tet_quality(const Tet& tet, const std::vector<Vec3>& X);

}  // namespace rend
