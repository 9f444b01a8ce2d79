// Agreeing directions: within patches by flooding, between patches by flipping whole patches.
#include "engine/core/error.h"
#include "engine/mesh/edge_uses.h"
#include "engine/mesh/repair_steps.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>

namespace rend {

namespace {

Real area_of(const TriangleSurface& s, std::size_t t) {
  const Vec3 a = s.corner(t, 0);
  return 0.5 * (s.corner(t, 1) - a).cross(s.corner(t, 2) - a).norm();
}

void flip(Triangle& t) { std::swap(t[1], t[2]); }

// Odd edges that dropping this patch would mend, minus those it would make.
std::vector<Index> gains(const TriangleSurface& surface, const TriangleGroups& patches) {
  std::vector<Index> gain(std::size_t(patches.count), 0);
  for_each_edge(edge_uses(surface.triangles), [&](std::span<const EdgeUse> uses) {
    if (uses.size() == 2) return;
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const Index patch = patches.label[std::size_t(uses[i].triangle)];
      std::size_t share = 0;
      bool first = true;
      for (std::size_t j = 0; j < uses.size(); ++j)
        if (patches.label[std::size_t(uses[j].triangle)] == patch) {
          ++share;
          first = first && j >= i;
        }
      if (first && share % 2 == 1) gain[std::size_t(patch)] += uses.size() % 2 == 1 ? 1 : -1;
    }
  });
  return gain;
}

// A patch at an edge of three or more triangles; only those can be too many.
std::vector<char> crowded(const TriangleSurface& surface, const TriangleGroups& patches) {
  std::vector<char> is(std::size_t(patches.count), 0);
  for_each_edge(edge_uses(surface.triangles), [&](std::span<const EdgeUse> uses) {
    if (uses.size() > 2)
      for (const EdgeUse& u : uses) is[std::size_t(patches.label[std::size_t(u.triangle)])] = 1;
  });
  return is;
}

}  // namespace

void drop_loose_patches(TriangleSurface& surface, Notes& notes) {
  std::size_t dropped = 0;
  for (int round = 0; round < 200; ++round) {
    const TriangleGroups patches = connected_triangles(surface, true);
    const std::vector<char> candidate = crowded(surface, patches);
    if (std::find(candidate.begin(), candidate.end(), 1) == candidate.end()) break;
    const std::vector<Index> gain = gains(surface, patches);
    std::vector<Real> area(std::size_t(patches.count), 0);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      area[std::size_t(patches.label[t])] += area_of(surface, t);
    Index worst = -1;
    for (Index p = 0; p < patches.count; ++p)
      if (candidate[std::size_t(p)] && gain[std::size_t(p)] > 0 &&
          (worst < 0 || area[std::size_t(p)] < area[std::size_t(worst)]))
        worst = p;
    if (worst < 0) break;
    std::vector<char> keep(surface.triangles.size());
    for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = patches.label[t] != worst;
    dropped += std::size_t(std::count(keep.begin(), keep.end(), 0));
    keep_triangles(surface, keep);
  }
  if (dropped > 0)
    notes.push_back(fmt::format("dropped {} faces of inner walls or loose flaps", dropped));
}

void orient(TriangleSurface& surface, Notes& notes) {
  struct Link {
    Index to;
    bool opposite;  // directions disagree
  };
  const std::size_t count = surface.triangles.size();
  std::vector<std::vector<Link>> links(count);
  const auto uses = edge_uses(surface.triangles);
  for_each_edge(uses, [&](std::span<const EdgeUse> pair) {
    if (pair.size() != 2) return;
    const bool opposite = pair[0].forward == pair[1].forward;
    links[std::size_t(pair[0].triangle)].push_back({pair[1].triangle, opposite});
    links[std::size_t(pair[1].triangle)].push_back({pair[0].triangle, opposite});
  });
  std::vector<signed char> turned(count, -1);
  std::size_t flipped = 0;
  for (std::size_t start = 0; start < count; ++start) {
    if (turned[start] >= 0) continue;
    std::vector<Index> patch = {Index(start)};
    turned[start] = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const auto t = std::size_t(patch[i]);
      for (const Link& link : links[t]) {
        const signed char wanted = static_cast<signed char>(turned[t] ^ int(link.opposite));
        signed char& other = turned[std::size_t(link.to)];
        if (other < 0) {
          other = wanted;
          patch.push_back(link.to);
        } else if (other != wanted) {
          throw Error("file", "is not a solid: its surface is one-sided " +
                                  near_text(surface.corner(t, 0)));
        }
      }
    }
    const auto minority = std::count_if(patch.begin(), patch.end(),
                                        [&](Index t) { return turned[std::size_t(t)] == 1; });
    const bool majority_turned = 2 * minority > std::ssize(patch);
    for (Index t : patch)
      if (bool(turned[std::size_t(t)]) != majority_turned) {
        flip(surface.triangles[std::size_t(t)]);
        ++flipped;
      }
  }
  // Where four or more triangles meet, whole patches may still run against each other.
  const TriangleGroups patches = connected_triangles(surface, true);
  for (int round = 0; round < 20; ++round) {
    std::vector<Index> gain(std::size_t(patches.count), 0);
    for_each_edge(edge_uses(surface.triangles), [&](std::span<const EdgeUse> at) {
      const int sum = imbalance(at);
      if (at.size() < 3 || sum == 0) return;
      for (const EdgeUse& u : at)
        gain[std::size_t(patches.label[std::size_t(u.triangle)])] +=
            (sum > 0) == u.forward ? 1 : -1;
    });
    const auto best = std::max_element(gain.begin(), gain.end());
    if (best == gain.end() || *best <= 0) break;
    for (std::size_t t = 0; t < count; ++t)
      if (patches.label[t] == Index(best - gain.begin())) {
        flip(surface.triangles[t]);
        ++flipped;
      }
  }
  if (flipped > 0) notes.push_back(fmt::format("turned {} faces round", flipped));
}

}  // namespace rend
