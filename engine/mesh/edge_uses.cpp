// Sorting instead of hashing: the order of edges is the same everywhere.
#include "engine/mesh/edge_uses.h"

#include <algorithm>
#include <tuple>

namespace rend {

std::vector<EdgeUse> edge_uses(const std::vector<Triangle>& triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      uses.push_back({{std::min(a, b), std::max(a, b)}, Index(t), a < b});
    }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.edge, a.triangle, a.forward) < std::tie(b.edge, b.triangle, b.forward);
  });
  return uses;
}

}  // namespace rend
