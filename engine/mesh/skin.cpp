// Boundary faces of tets, and whether they form closed manifolds.
#include "engine/mesh/clip.h"
#include "engine/mesh/edge_uses.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace rend {

namespace {

// Outward faces of a positive tet; face k is opposite vertex k.
constexpr int tet_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

}  // namespace

Triangle outward_face(const Tet& tet, int k) {
  return {tet[std::size_t(tet_face[k][0])], tet[std::size_t(tet_face[k][1])],
          tet[std::size_t(tet_face[k][2])]};
}

std::vector<Triangle> skin_of(const std::vector<Tet>& tets) {
  struct Face {
    Triangle key, outward;
  };
  std::vector<Face> faces;
  faces.reserve(4 * tets.size());
  for (const Tet& tet : tets)
    for (int k = 0; k < 4; ++k) {
      Face f{{}, outward_face(tet, k)};
      f.key = f.outward;
      std::sort(f.key.begin(), f.key.end());
      faces.push_back(f);
    }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const Face& a, const Face& b) { return a.key < b.key; });
  std::vector<Triangle> skin;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const bool shared = (i + 1 < faces.size() && faces[i + 1].key == faces[i].key) ||
                        (i > 0 && faces[i - 1].key == faces[i].key);
    if (!shared) skin.push_back(faces[i].outward);
  }
  return skin;
}

SkinDefects find_skin_defects(const std::vector<Triangle>& skin) {
  SkinDefects defects;
  for_each_edge(edge_uses(skin), [&](std::span<const EdgeUse> uses) {
    if (uses.size() != 2 || imbalance(uses) != 0) defects.edges.push_back(uses[0].edge);
  });

  // Around a vertex each triangle leads from one neighbour to the next; one fan means one cycle
  // through all.
  struct Step {
    Index centre, from, to;
  };
  std::vector<Step> steps;
  steps.reserve(3 * skin.size());
  for (const Triangle& t : skin)
    for (std::size_t k = 0; k < 3; ++k) steps.push_back({t[k], t[(k + 1) % 3], t[(k + 2) % 3]});
  std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) {
    return std::tie(a.centre, a.from) < std::tie(b.centre, b.from);
  });
  for (std::size_t i = 0; i < steps.size();) {
    std::size_t j = i;
    while (j < steps.size() && steps[j].centre == steps[i].centre) ++j;
    std::size_t length = 0;
    Index at = steps[i].from;
    do {
      const auto next =
          std::lower_bound(steps.begin() + std::ptrdiff_t(i), steps.begin() + std::ptrdiff_t(j), at,
                           [](const Step& s, Index from) { return s.from < from; });
      if (next == steps.begin() + std::ptrdiff_t(j) || next->from != at) break;
      at = next->to;
      ++length;
    } while (at != steps[i].from && length <= j - i);
    if (at != steps[i].from || length != j - i) defects.vertices.push_back(steps[i].centre);
    i = j;
  }
  return defects;
}

}  // namespace rend
