// Samples to tets to rest volumes.
#include "engine/mesh/body.h"

#include "engine/core/error.h"
#include "engine/mesh/clip.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

namespace rend {

namespace {

std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffull;
  v = (v | v << 16) & 0x1f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

// Neighbours in space become neighbours in memory (Morton order).
void sort_samples(Samples& samples) {
  const Bounds b = bounds_of(samples.X);
  const Real scale = 2097151 / std::max(b.size().maxCoeff(), 1e-300);
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (std::size_t i = 0; i < samples.X.size(); ++i) {
    const Vec3 c = scale * (samples.X[i] - b.low);
    order.emplace_back(spread_bits(std::uint64_t(c.x())) | spread_bits(std::uint64_t(c.y())) << 1 |
                           spread_bits(std::uint64_t(c.z())) << 2,
                       i);
  }
  std::sort(order.begin(), order.end());
  Samples sorted;
  sorted.spacing = samples.spacing;
  for (const auto& [code, i] : order) sorted.add(samples.X[i], samples.kind[i], samples.normal[i]);
  samples = std::move(sorted);
}

Real six_volumes(const Tet& t, const std::vector<Vec3>& X) {
  const Vec3& o = X[std::size_t(t[0])];
  return (X[std::size_t(t[1])] - o).dot((X[std::size_t(t[2])] - o).cross(X[std::size_t(t[3])] - o));
}

void drop_unused(Samples& samples, ClippedTets& clipped) {
  std::vector<Index> index(samples.X.size(), -1);
  Index count = 0;
  for (std::size_t i = 0; i < index.size(); ++i)
    if (clipped.used[i]) {
      samples.X[std::size_t(count)] = samples.X[i];
      samples.kind[std::size_t(count)] = samples.kind[i];
      index[i] = count++;
    }
  samples.X.resize(std::size_t(count));
  samples.kind.resize(std::size_t(count));
  for (Tet& t : clipped.tets)
    for (Index& v : t) v = index[std::size_t(v)];
  for (Triangle& t : clipped.skin)
    for (Index& v : t) v = index[std::size_t(v)];
}

}  // namespace

Body build_body(const Solid& solid, const SamplingOptions& options) {
  Samples samples = sample_solid(solid, options);
  sort_samples(samples);
  ClippedTets clipped = clip_to_solid(delaunay(samples.X), samples, solid);
  if (clipped.tets.empty())
    throw Error("", "no tetrahedron fits inside; use a smaller grid.dx or more particles_per_cell");
  Body body;
  const auto lost = std::count(clipped.used.begin(), clipped.used.end(), 0);
  if (lost > 0) {
    body.notes.push_back(
        fmt::format("{} particles were left out: no tetrahedron holds them", lost));
    drop_unused(samples, clipped);
  }
  if (clipped.open_defects > 0)
    body.notes.push_back(
        fmt::format("{} places of the surface are not manifold at this particle spacing",
                    clipped.open_defects));
  body.volume.assign(samples.X.size(), 0);
  Real total = 0;
  for (const Tet& t : clipped.tets) {
    const Real v = six_volumes(t, samples.X) / 24;
    for (Index i : t) body.volume[std::size_t(i)] += v;
    total += 4 * v;
  }
  for (Real& v : body.volume) v *= solid.volume() / total;
  for (SampleKind k : samples.kind) body.crease.push_back(k == SampleKind::crease);
  body.X = std::move(samples.X);
  body.tets = std::move(clipped.tets);
  body.skin = std::move(clipped.skin);
  return body;
}

}  // namespace rend
