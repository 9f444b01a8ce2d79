// One unknown per broken edge: moving along the edge keeps every sub-tet the right way round by
// construction.
#include "engine/fracture/smoothing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rend {

namespace {

constexpr Real t_min = 0.05, t_max = 0.95;
// Less than a whole step: a plane gets smooth almost as fast, a wavy face keeps more of its waves.
constexpr Real relaxation = 0.75;
constexpr Real crumb_share = 0.5;

// How much of the surroundings of p is on its side of a crack between p and q.
Real whole_share(const CrackMesh& crack, Index p, Index q, const CrackMotion* motion) {
  const TetTables& tables = crack.tables();
  const std::vector<Vec3>& X = tables.X;
  const Real h = tables.mean_edge[tables.body[p]];
  const auto weight = [&](Index b) { return std::exp(-(X[b] - X[p]).squaredNorm() / (h * h)); };
  Mat3 R_p, R_q;
  if (motion) {
    R_p = motion->rotations->of(p).toRotationMatrix();
    R_q = motion->rotations->of(q).toRotationMatrix();
  }
  const auto across = [&](Index b) {
    if (!motion) return 0.;
    const std::span<const Vec3> x = motion->x;
    const Real with_p = (x[b] - x[p] - R_p * (X[b] - X[p])).squaredNorm();
    const Real with_q = (x[b] - x[q] - R_q * (X[b] - X[q])).squaredNorm();
    return with_p > 0 ? with_p / (with_p + with_q) : 0;
  };
  Real sum = 1, total = 1;
  for (Index b : crack.linked(p)) {
    const Real w = weight(b);
    sum += w * (1 - 2 * across(b)), total += w;
  }
  for (Index b : crack.torn(p)) {
    const Real w = weight(b);
    sum -= w, total += w;
  }
  const Real whole = sum / total;
  // Torn from most of its neighbours it is a crumb, which keeps its size: drawn to nothing beside
  // whole matter but not beside other crumbs, it would be a star.
  return std::max(0.02, whole > 0 ? whole : -crumb_share * whole);
}

// The other two nodes of every triangle around each middle, both sides of the crack, side of the
// lower end first.
struct Fans {
  struct Wing {
    Index b, c;
  };
  std::vector<Index> row{0};
  std::vector<Wing> wings;
  std::vector<Index> first_side;  ///< wings of the lower end
};

Fans collect_fans(const CrackMesh& crack, std::span<const Index> records) {
  Fans fans;
  const auto skin_vertices = static_cast<Index>(crack.tables().skin_particle.size());
  const auto node = [&](Index corner) { return crack.copies()[corner - skin_vertices].node; };
  std::vector<TetEdge> ring;
  for (Index r : records) {
    const BrokenEdge& broken = crack.broken_edges()[r];
    crack.tables().ring(broken.edge, crack.ends(broken)[0], ring);
    for (int side = 0; side < 2; ++side) {
      const Index self = skin_vertices + broken.copy + side;
      for (const TetEdge& at : ring) {
        const auto& cracked = crack.cracked()[crack.cracked_of_tet(at.tet)];
        for (const CutTriangle& t : crack.triangles_of(cracked.triangles))
          for (int k = 0; k < 3; ++k)
            if (t[k] == self) fans.wings.push_back({node(t[(k + 1) % 3]), node(t[(k + 2) % 3])});
      }
      if (side == 0) fans.first_side.push_back(static_cast<Index>(fans.wings.size()));
    }
    fans.row.push_back(static_cast<Index>(fans.wings.size()));
  }
  return fans;
}

}  // namespace

void smooth_middles(CrackMesh& crack, std::span<const Index> records, int iterations,
                    const CrackMotion* motion) {
  if (iterations <= 0) return;
  const TetTables& tables = crack.tables();
  for (Index r : records) {
    const Edge end = crack.ends(crack.broken_edges()[r]);
    const Real f = whole_share(crack, end[0], end[1], motion);
    const Real g = whole_share(crack, end[1], end[0], motion);
    crack.place_middle(r, std::clamp(f / (f + g), t_min, t_max));
  }
  if (iterations <= 2) return;
  const Fans fans = collect_fans(crack, records);
  const std::vector<Vec3>& X = crack.nodes();
  for (int pass = 2; pass < iterations; ++pass)
    for (std::size_t i = 0; i < records.size(); ++i) {
      const BrokenEdge& b = crack.broken_edges()[records[i]];
      const Edge end = crack.ends(b);
      const Vec3& from = tables.X[end[0]];
      const Vec3 edge = tables.X[end[1]] - from;
      const Vec3 self = X[crack.copies()[b.copy].node];
      Vec3 normal = Vec3::Zero(), mean = Vec3::Zero();
      for (Index w = fans.row[i]; w < fans.row[i + 1]; ++w) {
        const Vec3 &p = X[fans.wings[w].b], &q = X[fans.wings[w].c];
        const Vec3 cross = (p - self).cross(q - self);
        normal += w < fans.first_side[i] ? cross : Vec3(-cross);
        mean += p + q;
      }
      mean /= 2 * (fans.row[i + 1] - fans.row[i]);
      const Real slope = normal.dot(edge);
      const bool steep = std::abs(slope) > 0.15 * normal.norm() * edge.norm();
      const Real target = steep ? normal.dot(mean - from) / slope
                                : b.t + 0.5 * (mean - self).dot(edge) / edge.squaredNorm();
      crack.place_middle(records[i], std::clamp(b.t + relaxation * (target - b.t), t_min, t_max));
    }
}

}  // namespace rend
