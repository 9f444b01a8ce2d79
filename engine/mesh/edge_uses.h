// Which triangles use which edge, and in which direction.
#pragma once

#include "engine/core/types.h"

#include <span>
#include <vector>

namespace rend {

/// One side of a triangle; `forward` when the triangle runs from the smaller vertex to the larger
/// one.
struct EdgeUse {
  Edge edge;  ///< smaller vertex first
  Index triangle;
  bool forward;
};

/// All sides of all triangles, sorted so that uses of the same edge are neighbours.
std::vector<EdgeUse> edge_uses(const std::vector<Triangle>& triangles);

/// Calls body(span of uses) once an edge.
template <class F>
void for_each_edge(const std::vector<EdgeUse>& uses, F&& body) {
  for (std::size_t i = 0, j; i < uses.size(); i = j) {
    for (j = i + 1; j < uses.size() && uses[j].edge == uses[i].edge;) ++j;
    body(std::span<const EdgeUse>(&uses[i], j - i));
  }
}

/// Uses forward minus uses backward; zero for every edge of a closed oriented surface.
inline int imbalance(std::span<const EdgeUse> uses) {
  int sum = 0;
  for (const EdgeUse& u : uses) sum += u.forward ? 1 : -1;
  return sum;
}

}  // namespace rend
