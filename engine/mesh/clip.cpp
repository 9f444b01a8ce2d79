// Which Delaunay tets belong to the solid.
#include "engine/mesh/clip.h"

#include "engine/core/parallel.h"
#include "engine/mesh/solid_cells.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <span>
#include <unordered_set>

namespace rend {

namespace {

enum class Verdict : std::uint8_t {
  out,       // centroid outside
  flat,      // no volume to speak of: rounding of coplanar samples
  doubtful,  // centroid inside, circumcentre outside, all corners on the surface
  in
};

struct Shape {
  Vec3 centroid, circumcentre;
  Real volume;
};

Shape shape_of(const Tet& tet, const std::vector<Vec3>& X) {
  const Vec3& o = X[std::size_t(tet[0])];
  const Vec3 a = X[std::size_t(tet[1])] - o, b = X[std::size_t(tet[2])] - o,
             c = X[std::size_t(tet[3])] - o;
  const Real six_volumes = a.dot(b.cross(c));
  const Vec3 numerator =
      a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b);
  return {o + 0.25 * (a + b + c), o + numerator / (2 * six_volumes), six_volumes / 6};
}

class Clipper {
 public:
  Clipper(const DelaunayCells& cells, const Samples& samples, const Solid& solid)
      : cells_(cells),
        samples_(samples),
        count_(Index(cells.tets.size())),
        verdict_(cells.tets.size()),
        kept_(cells.tets.size()),
        flips_(cells.tets.size(), 0) {
    judge(solid);
    fill_enclosed_gaps();
  }

  int make_manifold() {
    int changed = 0;
    for (int round = 0; round < 60; ++round) {
      const SkinDefects defects = find_skin_defects(skin());
      if (defects.edges.empty() && defects.vertices.empty()) break;
      if (incident_.empty()) index_incident_cells();
      changed_vertices_.clear();
      const int before = changed;
      for (const Edge& e : defects.edges) {
        if (changed_vertices_.count(e[0]) || changed_vertices_.count(e[1])) continue;
        changed += mend(around_edge(e));
      }
      for (Index v : defects.vertices)
        if (!changed_vertices_.count(v))
          changed += mend(CellList(incident(v).begin(), incident(v).end()));
      if (changed == before) break;
    }
    return changed;
  }

  ClippedTets result() const {
    ClippedTets r;
    r.used.assign(samples_.X.size(), 0);
    for (Index c = 0; c < count_; ++c)
      if (kept_[std::size_t(c)]) {
        r.tets.push_back(tet(c));
        for (Index v : tet(c)) r.used[std::size_t(v)] = 1;
      }
    r.skin = skin();
    const SkinDefects defects = find_skin_defects(r.skin);
    r.open_defects = int(defects.edges.size() + defects.vertices.size());
    return r;
  }

 private:
  using CellList = std::vector<Index>;

  const Tet& tet(Index c) const { return cells_.tets[std::size_t(c)]; }
  Index neighbour(Index c, int k) const {
    return cells_.neighbours[std::size_t(c)][std::size_t(k)];
  }
  bool is_kept(Index c) const { return c >= 0 && kept_[std::size_t(c)]; }

  void judge(const Solid& solid) {
    const Real h = samples_.spacing;
    const SolidCells inside(solid, h, 0);
    parallel_for(count_, 2048, [&](Index c) {
      const Shape s = shape_of(tet(c), samples_.X);
      const Real size = s.volume / (h * h * h);
      const bool all_surface = std::all_of(tet(c).begin(), tet(c).end(), [&](Index v) {
        return samples_.kind[std::size_t(v)] != SampleKind::interior;
      });
      Verdict& verdict = verdict_[std::size_t(c)];
      if (all_surface && size < 1e-6)
        verdict = Verdict::flat;
      else if (!inside.inside(s.centroid))
        verdict = Verdict::out;
      else
        verdict = all_surface && bulges_out(tet(c), s, size) ? Verdict::doubtful : Verdict::in;
      kept_[std::size_t(c)] = verdict == Verdict::in;
    });
  }

  // Whether the tet lies along one sheet of the surface, with its circumcentre on the outer side.
  // The side is told by normals: the circumcentre of a flat tet may be so far in that it comes out
  // at the back.
  bool bulges_out(const Tet& t, const Shape& s, Real size) const {
    // Across a crease the normals differ more; there a tet spans the edge and must stay.
    const bool at_crease = std::any_of(t.begin(), t.end(), [&](Index v) {
      return samples_.kind[std::size_t(v)] == SampleKind::crease;
    });
    const Real alike = at_crease ? 0.9 : 0.5;
    int with_normal = 0;
    Vec3 mean = Vec3::Zero();
    for (Index a : t) {
      const Vec3& n = samples_.normal[std::size_t(a)];
      if (n.isZero()) continue;
      ++with_normal;
      mean += n;
      for (Index b : t)
        if (const Vec3& m = samples_.normal[std::size_t(b)]; !m.isZero() && n.dot(m) < alike)
          return false;
    }
    if (with_normal == 0 || (with_normal == 1 && size > 1e-3)) return false;
    return (s.circumcentre - s.centroid).dot(mean) > 0;
  }

  // Dropped tets that the outside cannot reach are holes of the rule, not of the solid.
  void fill_enclosed_gaps() {
    std::vector<char> open(std::size_t(count_), 0);
    CellList stack;
    const auto visit = [&](Index c) {
      if (c < 0 || is_kept(c) || open[std::size_t(c)]) return;
      open[std::size_t(c)] = 1;
      stack.push_back(c);
    };
    for (Index c = 0; c < count_; ++c) {
      const auto& n = cells_.neighbours[std::size_t(c)];
      if (verdict_[std::size_t(c)] == Verdict::out || std::find(n.begin(), n.end(), -1) != n.end())
        visit(c);
    }
    while (!stack.empty()) {
      const Index c = stack.back();
      stack.pop_back();
      for (int k = 0; k < 4; ++k) visit(neighbour(c, k));
    }
    for (Index c = 0; c < count_; ++c)
      if (!open[std::size_t(c)]) kept_[std::size_t(c)] = 1;
  }

  std::vector<Triangle> skin() const {
    std::vector<Triangle> faces;
    for (Index c = 0; c < count_; ++c)
      for (int k = 0; k < 4; ++k)
        if (is_kept(c) && !is_kept(neighbour(c, k))) faces.push_back(outward_face(tet(c), k));
    return faces;
  }

  void index_incident_cells() {
    first_incident_.assign(samples_.X.size() + 1, 0);
    for (const Tet& t : cells_.tets)
      for (Index v : t) ++first_incident_[std::size_t(v) + 1];
    std::partial_sum(first_incident_.begin(), first_incident_.end(), first_incident_.begin());
    incident_.resize(4 * cells_.tets.size());
    auto next = first_incident_;
    for (Index c = 0; c < count_; ++c)
      for (Index v : tet(c)) incident_[std::size_t(next[std::size_t(v)]++)] = c;
  }
  std::span<const Index> incident(Index v) const {
    const auto begin = std::size_t(first_incident_[std::size_t(v)]);
    return {incident_.data() + begin, std::size_t(first_incident_[std::size_t(v) + 1]) - begin};
  }
  CellList around_edge(const Edge& e) const {
    CellList ring;
    for (Index c : incident(e[0]))
      if (std::find(tet(c).begin(), tet(c).end(), e[1]) != tet(c).end()) ring.push_back(c);
    return ring;
  }

  // Groups of face-connected tets of `ring` that are all kept or all not kept.
  std::vector<CellList> groups(const CellList& ring) const {
    std::vector<CellList> all;
    std::unordered_set<Index> left(ring.begin(), ring.end());
    for (Index start : ring) {
      if (!left.erase(start)) continue;
      CellList group = {start};
      for (std::size_t i = 0; i < group.size(); ++i)
        for (int k = 0; k < 4; ++k) {
          const Index n = neighbour(group[i], k);
          if (n >= 0 && is_kept(n) == is_kept(start) && left.erase(n)) group.push_back(n);
        }
      all.push_back(group);
    }
    return all;
  }

  // Flips the group of tets around a bad edge or vertex that changes the least volume, weighing
  // doubtful tets low.
  int mend(const CellList& ring) {
    const std::vector<CellList> all = groups(ring);
    const auto kept_groups = std::count_if(all.begin(), all.end(),
                                           [&](const CellList& g) { return is_kept(g.front()); });
    const CellList* best = nullptr;
    Real best_cost = 1e300;
    for (const CellList& g : all) {
      if (is_kept(g.front()) && (kept_groups < 2 || loses_sample(g))) continue;
      const Real cost = flip_cost(g);
      if (cost < best_cost) {
        best_cost = cost;
        best = &g;
      }
    }
    if (!best) return 0;
    const bool keep = !is_kept(best->front());
    for (Index c : *best) {
      kept_[std::size_t(c)] = keep;
      ++flips_[std::size_t(c)];
      changed_vertices_.insert(tet(c).begin(), tet(c).end());
    }
    return int(best->size());
  }
  // Volume changed [m3], weighed: tets without volume are no use to anybody who computes with them.
  Real flip_cost(const CellList& g) const {
    const Real h = samples_.spacing;
    const bool adds = !is_kept(g.front());
    Real cost = 0;
    for (Index c : g) {
      const Verdict v = verdict_[std::size_t(c)];
      const Real volume = shape_of(tet(c), samples_.X).volume +
                          (adds && v == Verdict::flat ? 2e-3 : 1e-6) * h * h * h;
      cost += volume * (v == Verdict::out ? 4 : 1) * (1 + 10 * flips_[std::size_t(c)]);
    }
    return cost;
  }
  bool loses_sample(const CellList& g) const {
    return std::any_of(g.begin(), g.end(), [&](Index dropped) {
      return std::any_of(tet(dropped).begin(), tet(dropped).end(), [&](Index v) {
        const auto around = incident(v);
        return std::all_of(around.begin(), around.end(), [&](Index c) {
          return !is_kept(c) || std::find(g.begin(), g.end(), c) != g.end();
        });
      });
    });
  }

  const DelaunayCells& cells_;
  const Samples& samples_;
  Index count_;
  std::vector<Verdict> verdict_;
  std::vector<char> kept_;
  std::vector<int> flips_;                        // makes undoing dear, so that mending ends
  std::vector<Index> first_incident_, incident_;  // tets around each sample
  // Defects at these vertices are judged anew in the next round.
  std::unordered_set<Index> changed_vertices_;
};

}  // namespace

ClippedTets clip_to_solid(const DelaunayCells& cells, const Samples& samples, const Solid& solid) {
  Clipper clipper(cells, samples, solid);
  const int repairs = clipper.make_manifold();
  ClippedTets result = clipper.result();
  result.manifold_repairs = repairs;
  return result;
}

}  // namespace rend
