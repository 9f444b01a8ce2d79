// Delaunay tets cut down to a solid, with a closed manifold skin.
#pragma once

#include "engine/mesh/delaunay.h"
#include "engine/mesh/sampling.h"

#include <string>

namespace rend {

/// What is left of the Delaunay tets.
struct ClippedTets {
  std::vector<Tet> tets;
  std::vector<Triangle> skin;  ///< outward faces with a tet on one side only
  std::vector<char> used;      ///< #samples: in at least one tet
  int manifold_repairs = 0;    ///< tets added or dropped to make the skin manifold
  int open_defects = 0;        ///< skin edges and vertices that are still not manifold
};

/// Keeps a tet when its centroid is inside and, when its corners are surface samples that face
/// alike, its circumcentre is on their inner side: without the second condition concave surfaces
/// fill up with flat tets. Then makes the skin manifold.
ClippedTets clip_to_solid(const DelaunayCells& cells, const Samples& samples, const Solid& solid);

/// Outward face opposite vertex k of a positive tet.
Triangle outward_face(const Tet& tet, int k);

/// Faces of tets that have no neighbour, outward.
std::vector<Triangle> skin_of(const std::vector<Tet>& tets);

/// Edges without exactly one triangle on each side, and vertices whose triangles do not form a
/// single fan.
struct SkinDefects {
  std::vector<Edge> edges;
  std::vector<Index> vertices;
};
SkinDefects find_skin_defects(const std::vector<Triangle>& skin);

}  // namespace rend
