// Maximal Poisson-disk sets in a volume: darts into cubes, covered cubes are dropped, the others
// split (White et al. 2007, "Poisson disk point sets by hierarchical dart throwing").
#include "engine/core/parallel.h"
#include "engine/core/random.h"
#include "engine/mesh/point_grid.h"
#include "engine/mesh/sampling.h"
#include "engine/mesh/solid_cells.h"

#include <algorithm>

namespace rend {

namespace {

struct Cube {
  Vec3 low;
  bool deep;
};

Real farthest_squared(const Vec3& p, const Vec3& low, Real side) {
  return (p - low).cwiseAbs().cwiseMax((p - low - Vec3::Constant(side)).cwiseAbs()).squaredNorm();
}

// Eight children of every cube that no single sample covers; order kept whatever the threads do.
std::vector<Cube> split_uncovered(const std::vector<Cube>& cubes, Real side, Real radius,
                                  const PointGrid& grid, const SolidCells& cells) {
  const Index grain = 1024, count = Index(cubes.size());
  std::vector<std::vector<Cube>> part(std::size_t((count + grain - 1) / grain));
  const Real half = 0.5 * side, r2 = radius * radius;
  parallel_chunks(count, grain, [&](Index begin, Index end) {
    std::vector<Cube>& out = part[std::size_t(begin / grain)];
    std::vector<Vec3> near;
    const auto covered = [&](const Vec3& low, Real edge) {
      return std::any_of(near.begin(), near.end(),
                         [&](const Vec3& p) { return farthest_squared(p, low, edge) < r2; });
    };
    for (Index i = begin; i < end; ++i) {
      const Cube& cube = cubes[std::size_t(i)];
      near.clear();
      // One look-up for the cube and its children.
      const bool done = grid.any_near(cube.low + Vec3::Constant(half), [&](Index p, Real d2) {
        const Vec3& x = grid.points()[std::size_t(p)];
        if (d2 < r2 && farthest_squared(x, cube.low, side) < r2) return true;
        if (d2 < 1.5 * r2) near.push_back(x);
        return false;
      });
      if (done) continue;
      for (int c = 0; c < 8; ++c) {
        const Vec3 low = cube.low + half * Vec3(c & 1, c >> 1 & 1, c >> 2 & 1);
        if (covered(low, half)) continue;
        if (cube.deep || cells.touches_depth(low + Vec3::Constant(0.5 * half), half))
          out.push_back({low, cube.deep});
      }
    }
  });
  std::vector<Cube> all;
  for (const auto& p : part) all.insert(all.end(), p.begin(), p.end());
  return all;
}

}  // namespace

void add_poisson_disk(const Solid& solid, Real radius, Real depth, std::uint64_t seed,
                      std::uint64_t stream, Samples& samples) {
  const SolidCells cells(solid, 0.5 * radius, depth);
  PointGrid grid(solid.bounds(), radius);
  for (const Vec3& x : samples.X) grid.add(x);
  Random random(seed, 4 * stream + 2);
  std::vector<Cube> active;
  const Vec3i n = cells.lattice().size;
  for (int z = 0; z < n.z(); ++z)
    for (int y = 0; y < n.y(); ++y)
      for (int x = 0; x < n.x(); ++x)
        if (const auto s = cells.state({x, y, z}); s != SolidCells::outside)
          active.push_back({cells.lattice().corner({x, y, z}), s == SolidCells::deep});
  Real side = cells.lattice().side;
  const Real r2 = radius * radius;
  const int rounds = 4;
  for (int round = 1; !active.empty(); ++round) {
    for (std::size_t i = active.size(); i > 1; --i)
      std::swap(active[i - 1], active[std::size_t(random.next() * Real(i))]);
    for (const Cube& cube : active) {
      const Vec3 x = cube.low + side * Vec3(random.next(), random.next(), random.next());
      if (grid.any_near(x, [&](Index, Real d2) { return d2 < r2; })) continue;
      if (!cube.deep && !cells.is_deep(x)) continue;
      grid.add(x);
      samples.add(x, SampleKind::interior);
    }
    if (round == rounds) break;
    active = split_uncovered(active, side, radius, grid, cells);
    side *= 0.5;
  }
}

}  // namespace rend
