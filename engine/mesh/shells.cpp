// Closed shells: which way they face, which lie inside which, and which do not count.
#include "engine/core/error.h"
#include "engine/mesh/repair_steps.h"
#include "engine/mesh/triangle_bvh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace rend {

namespace {

// Shells smaller than this share of the largest one are crumbs.
constexpr Real tiny_share = 1e-6;

struct Shell {
  TriangleSurface surface;
  Bounds bounds;
  Real volume = 0;
  std::unique_ptr<TriangleBvh> bvh;

  bool contains(const Shell& other) {
    if ((other.bounds.low.array() < bounds.low.array()).any() ||
        (other.bounds.high.array() > bounds.high.array()).any())
      return false;
    if (!bvh) bvh = std::make_unique<TriangleBvh>(surface);
    // A shell inside touches nothing, so any few of its points tell.
    const auto& x = other.surface.positions;
    for (std::size_t i : {std::size_t(0), x.size() / 2, x.size() - 1})
      if (std::abs(bvh->winding_number(x[i])) < 0.5) return false;
    return true;
  }
};

std::vector<Shell> split_shells(const TriangleSurface& surface) {
  const TriangleGroups groups = connected_triangles(surface, false);
  std::vector<Shell> shells(std::size_t(groups.count));
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    shells[std::size_t(groups.label[t])].surface.triangles.push_back(surface.triangles[t]);
  std::vector<Index> local(surface.positions.size(), -1);
  for (Shell& s : shells) {
    const auto original = s.surface.triangles;
    for (Triangle& t : s.surface.triangles)
      for (Index& v : t) {
        Index& l = local[std::size_t(v)];
        if (l < 0) {
          l = Index(s.surface.positions.size());
          s.surface.positions.push_back(surface.positions[std::size_t(v)]);
        }
        v = l;
      }
    for (const Triangle& t : original)
      for (Index v : t) local[std::size_t(v)] = -1;
    s.bounds = bounds_of(s.surface.positions);
    s.volume = enclosed_volume(s.surface);
  }
  std::stable_sort(shells.begin(), shells.end(), [](const Shell& a, const Shell& b) {
    return std::abs(a.volume) > std::abs(b.volume);
  });
  return shells;
}

}  // namespace

void settle_shells(TriangleSurface& surface, Notes& notes) {
  const Real cube = std::pow(bounds_of(surface.positions).size().norm(), 3);
  std::vector<Shell> shells = split_shells(surface);
  const Real largest = std::abs(shells.front().volume);
  if (!(largest > 1e-9 * cube))
    throw Error("file", "is not a solid: its surface encloses no volume");
  const auto tiny = std::find_if(shells.begin(), shells.end(), [&](const Shell& s) {
    return std::abs(s.volume) < tiny_share * largest;
  });
  const auto crumbs = shells.end() - tiny;
  shells.erase(tiny, shells.end());
  surface = {};
  std::size_t turned = 0, cavities = 0, doubled = 0;
  std::vector<bool> hollow(shells.size(), false);
  for (std::size_t i = 0; i < shells.size(); ++i) {
    std::size_t parent = i;
    for (std::size_t j = 0; j < i; ++j)
      if (shells[j].contains(shells[i])) parent = j;
    const bool nested = parent != i;
    const bool same_way = nested && (shells[parent].volume > 0) == (shells[i].volume > 0);
    if (nested && same_way && !hollow[parent]) {
      // Inside matter already; its sign is kept for what lies inside of it.
      ++doubled;
      continue;
    }
    hollow[i] = nested && !same_way && !hollow[parent];
    cavities += hollow[i];
    const bool flip = (shells[i].volume > 0) == hollow[i];
    turned += flip;
    const Index first = Index(surface.positions.size());
    surface.positions.insert(surface.positions.end(), shells[i].surface.positions.begin(),
                             shells[i].surface.positions.end());
    for (const Triangle& t : shells[i].surface.triangles)
      surface.triangles.push_back(flip ? Triangle{t[0] + first, t[2] + first, t[1] + first}
                                       : Triangle{t[0] + first, t[1] + first, t[2] + first});
  }
  if (crumbs > 0) notes.push_back(fmt::format("dropped {} tiny or flat shells", crumbs));
  if (doubled > 0) notes.push_back(fmt::format("dropped {} shells inside others", doubled));
  if (cavities > 0) notes.push_back(fmt::format("kept {} cavities", cavities));
  if (turned > 0) notes.push_back(fmt::format("turned {} shells inside out", turned));
}

}  // namespace rend
