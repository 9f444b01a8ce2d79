// Holes are closed by the triangulation of least area of their rim.
#include "engine/core/error.h"
#include "engine/mesh/edge_uses.h"
#include "engine/mesh/repair_steps.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <map>

namespace rend {

namespace {

constexpr std::size_t most_edges = 100;
constexpr Real longest_rim = 0.1;  // of the bounding box's diagonal

using Rim = std::vector<Index>;  // in the direction of the missing triangles

// Rims by walking the unpaired edges backwards; a rim that touches itself is cut into simple ones.
std::vector<Rim> find_rims(const TriangleSurface& surface) {
  std::map<Index, std::vector<Index>> next;
  for_each_edge(edge_uses(surface.triangles), [&](std::span<const EdgeUse> uses) {
    const int sum = imbalance(uses);
    const auto [a, b] = uses[0].edge;
    for (int i = 0; i < std::abs(sum); ++i) next[sum > 0 ? b : a].push_back(sum > 0 ? a : b);
  });
  std::vector<Rim> rims;
  for (auto& [start, unused] : next)
    while (!next[start].empty()) {
      Rim path = {start};
      Index at = start;
      while (!next[at].empty()) {
        const Index to = next[at].back();
        next[at].pop_back();
        const auto seen = std::find(path.begin(), path.end(), to);
        if (seen != path.end()) {
          rims.emplace_back(seen, path.end());
          path.erase(seen + 1, path.end());
        } else {
          path.push_back(to);
        }
        at = to;
      }
    }
  return rims;
}

Real rim_length(const TriangleSurface& s, const Rim& rim) {
  Real length = 0;
  for (std::size_t i = 0; i < rim.size(); ++i)
    length +=
        (s.positions[std::size_t(rim[i])] - s.positions[std::size_t(rim[(i + 1) % rim.size()])])
            .norm();
  return length;
}

void fan(TriangleSurface& s, const Rim& rim) {
  Vec3 centre = Vec3::Zero();
  for (Index v : rim) centre += s.positions[std::size_t(v)] / Real(rim.size());
  const Index c = Index(s.positions.size());
  s.positions.push_back(centre);
  for (std::size_t i = 0; i < rim.size(); ++i)
    s.triangles.push_back({rim[i], rim[(i + 1) % rim.size()], c});
}

// Dynamic programming over chords (Barequet and Sharir 1995), O(n^3).
void least_area(TriangleSurface& s, const Rim& rim) {
  const std::size_t n = rim.size();
  std::vector<Real> cost(n * n, 0);
  std::vector<std::size_t> apex(n * n, 0);
  const auto x = [&](std::size_t i) -> const Vec3& { return s.positions[std::size_t(rim[i])]; };
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t k = i + span;
      Real best = 1e300;
      for (std::size_t j = i + 1; j < k; ++j) {
        const Real c = cost[i * n + j] + cost[j * n + k] + (x(j) - x(i)).cross(x(k) - x(i)).norm();
        if (c < best) {
          best = c;
          apex[i * n + k] = j;
        }
      }
      cost[i * n + k] = best;
    }
  std::vector<std::pair<std::size_t, std::size_t>> open = {{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k - i < 2) continue;
    const std::size_t j = apex[i * n + k];
    s.triangles.push_back({rim[i], rim[j], rim[k]});
    open.push_back({i, j});
    open.push_back({j, k});
  }
}

}  // namespace

void close_holes(TriangleSurface& surface, Notes& notes) {
  const Real diagonal = bounds_of(surface.positions).size().norm();
  std::vector<Rim> rims = find_rims(surface);
  if (rims.empty()) return;
  const auto largest = std::max_element(
      rims.begin(), rims.end(), [](const Rim& a, const Rim& b) { return a.size() < b.size(); });
  std::size_t edges = 0, closed = 0;
  for (const Rim& rim : rims) {
    edges += rim.size();
    const bool few = rim.size() <= most_edges,
               is_short = rim_length(surface, rim) < longest_rim * diagonal;
    if (rim.size() >= 3 && !few && !is_short)
      throw Error("file",
                  fmt::format(
                      "is not a solid: {} hole{} with {} open edges, the largest with {} edges {}; "
                      "holes of up to {} edges are closed",
                      rims.size(), rims.size() == 1 ? "" : "s",
                      [&] {
                        std::size_t all = 0;
                        for (const Rim& r : rims) all += r.size();
                        return all;
                      }(),
                      largest->size(), near_text(surface.positions[std::size_t(largest->front())]),
                      most_edges));
  }
  for (const Rim& rim : rims) {
    if (rim.size() < 3) continue;
    rim.size() <= 2 * most_edges ? least_area(surface, rim) : fan(surface, rim);
    ++closed;
  }
  notes.push_back(fmt::format("closed {} hole{} with {} edges, the largest {}", closed,
                              closed == 1 ? "" : "s", edges,
                              near_text(surface.positions[std::size_t(largest->front())])));
  std::size_t open = 0;
  Vec3 at = Vec3::Zero();
  for_each_edge(edge_uses(surface.triangles), [&](std::span<const EdgeUse> uses) {
    if (imbalance(uses) == 0) return;
    ++open;
    at = surface.positions[std::size_t(uses[0].edge[0])];
  });
  if (open > 0)
    throw Error("file", fmt::format("is not a solid: {} open edges {}", open, near_text(at)));
}

}  // namespace rend
