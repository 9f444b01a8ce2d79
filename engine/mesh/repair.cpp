// Runs the repair steps.
#include "engine/mesh/repair.h"

#include "engine/core/error.h"
#include "engine/core/random.h"
#include "engine/mesh/edge_uses.h"
#include "engine/mesh/repair_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace rend {

std::string near_text(const Vec3& x) {
  return fmt::format("near ({:.4g}, {:.4g}, {:.4g})", x.x(), x.y(), x.z());
}

TriangleGroups connected_triangles(const TriangleSurface& surface, bool only_pairs) {
  std::vector<Index> root(surface.triangles.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index t) {
    while (root[std::size_t(t)] != t)
      t = root[std::size_t(t)] = root[std::size_t(root[std::size_t(t)])];
    return t;
  };
  for_each_edge(edge_uses(surface.triangles), [&](std::span<const EdgeUse> uses) {
    if (only_pairs && uses.size() != 2) return;
    for (const EdgeUse& u : uses) {
      const Index a = find(uses[0].triangle), b = find(u.triangle);
      root[std::size_t(std::max(a, b))] = std::min(a, b);
    }
  });
  TriangleGroups groups;
  groups.label.resize(root.size());
  for (std::size_t t = 0; t < root.size(); ++t) {
    const Index r = find(Index(t));
    groups.label[t] = r == Index(t) ? groups.count++ : groups.label[std::size_t(r)];
  }
  return groups;
}

void keep_triangles(TriangleSurface& surface, const std::vector<char>& keep) {
  std::size_t n = 0;
  for (std::size_t t = 0; t < keep.size(); ++t)
    if (keep[t]) surface.triangles[n++] = surface.triangles[t];
  surface.triangles.resize(n);
}

void weld(TriangleSurface& surface, Real tolerance) {
  const Vec3 low = bounds_of(surface.positions).low;
  const Real side = std::max(16 * tolerance, 1e-300);
  // A point is looked up in the cells that its tolerance box touches, mostly one; the first point
  // wins.
  std::unordered_map<std::uint64_t, Index> head;
  head.reserve(surface.positions.size());
  std::vector<Index> target(surface.positions.size()), next;
  std::vector<Vec3> kept;
  const auto cell = [&](const Vec3& x) { return Vec3(((x - low) / side).array().floor()); };
  // Cells that share a key by chance only cost a comparison.
  const auto key = [](const Vec3& c) {
    std::uint64_t k = 0;
    for (Real v : {c.x(), c.y(), c.z()}) k = mix_bits(k ^ std::uint64_t(std::int64_t(v)));
    return k;
  };
  for (std::size_t i = 0; i < surface.positions.size(); ++i) {
    const Vec3& x = surface.positions[i];
    const Vec3 a = cell(x - Vec3::Constant(tolerance)), b = cell(x + Vec3::Constant(tolerance));
    Index found = -1;
    for (Real u = a.x(); u <= b.x(); ++u)
      for (Real v = a.y(); v <= b.y(); ++v)
        for (Real w = a.z(); w <= b.z(); ++w) {
          const auto at = head.find(key({u, v, w}));
          for (Index k = at == head.end() ? -1 : at->second; k >= 0; k = next[std::size_t(k)])
            if ((kept[std::size_t(k)] - x).norm() <= tolerance && (found < 0 || k < found))
              found = k;
        }
    if (found < 0) {
      found = Index(kept.size());
      kept.push_back(x);
      Index& first = head.try_emplace(key(cell(x)), -1).first->second;
      next.push_back(first);
      first = found;
    }
    target[i] = found;
  }
  std::vector<Index> compact(kept.size(), -1);
  surface.positions.clear();
  for (Triangle& t : surface.triangles)
    for (Index& v : t) {
      Index& c = compact[std::size_t(target[std::size_t(v)])];
      if (c < 0) {
        c = Index(surface.positions.size());
        surface.positions.push_back(kept[std::size_t(target[std::size_t(v)])]);
      }
      v = c;
    }
}

void drop_degenerate_and_duplicate(TriangleSurface& surface, Notes& notes) {
  std::vector<char> keep(surface.triangles.size(), 1);
  std::vector<std::pair<Triangle, std::size_t>> sets;
  std::size_t degenerate = 0, duplicate = 0;
  for (std::size_t t = 0; t < keep.size(); ++t) {
    Triangle key = surface.triangles[t];
    std::sort(key.begin(), key.end());
    if (key[0] == key[1] || key[1] == key[2]) {
      keep[t] = 0;
      ++degenerate;
    } else {
      sets.emplace_back(key, t);
    }
  }
  std::sort(sets.begin(), sets.end());
  for (std::size_t i = 1; i < sets.size(); ++i)
    if (sets[i].first == sets[i - 1].first) {
      keep[sets[i].second] = 0;
      ++duplicate;
    }
  keep_triangles(surface, keep);
  if (degenerate > 0) notes.push_back(fmt::format("dropped {} faces without area", degenerate));
  if (duplicate > 0)
    notes.push_back(fmt::format("dropped {} faces that were there twice", duplicate));
}

TriangleSurface repair_surface(TriangleSurface surface, std::vector<std::string>& notes) {
  if (surface.triangles.empty()) throw Error("file", "holds no triangles");
  for (const Vec3& x : surface.positions)
    if (!x.allFinite()) throw Error("file", "has a vertex that is not a number");
  weld(surface, 1e-6 * bounds_of(surface.positions).size().norm());
  drop_degenerate_and_duplicate(surface, notes);
  drop_loose_patches(surface, notes);
  if (surface.triangles.empty()) throw Error("file", "is not a solid: no face has area");
  orient(surface, notes);
  close_holes(surface, notes);
  settle_shells(surface, notes);
  return surface;
}

}  // namespace rend
