// Which Delaunay tets belong to the solid.
#include "engine/mesh/clip.h"

#include "engine/core/parallel.h"
#include "engine/mesh/solid_cells.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <unordered_map>
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
        kept_(cells.tets.size()) {
    judge(solid);
    fill_enclosed_gaps();
  }

  int make_manifold() {
    int changed = 0;
    for (int round = 0; round < 60; ++round) {
      const SkinDefects defects = find_skin_defects(skin());
      if (defects.edges.empty() && defects.vertices.empty()) break;
      index_incident_cells(defects);
      changed_vertices_.clear();
      const int before = changed;
      for (const Edge& e : defects.edges) {
        if (changed_vertices_.count(e[0]) || changed_vertices_.count(e[1])) continue;
        changed += mend(around_edge(e));
      }
      for (Index v : defects.vertices)
        if (!changed_vertices_.count(v)) changed += mend(incident_.at(v));
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
      const auto on_surface = [&](Index v) {
        return samples_.kind[std::size_t(v)] != SampleKind::interior;
      };
      Verdict& verdict = verdict_[std::size_t(c)];
      if (!inside.inside(s.centroid)) {
        verdict = Verdict::out;
      } else if (std::all_of(tet(c).begin(), tet(c).end(), on_surface)) {
        if (s.volume < 1e-9 * h * h * h)
          verdict = Verdict::flat;
        else
          verdict = !on_one_sheet(tet(c)) || inside.inside(s.circumcentre) ? Verdict::in
                                                                           : Verdict::doubtful;
      } else {
        verdict = Verdict::in;
      }
      kept_[std::size_t(c)] = verdict == Verdict::in;
    });
  }

  bool on_one_sheet(const Tet& t) const {
    int with_normal = 0;
    for (Index a : t)
      for (Index b : t) {
        const Vec3 &n = samples_.normal[std::size_t(a)], &m = samples_.normal[std::size_t(b)];
        if (n.isZero() || m.isZero()) continue;
        if (n.dot(m) < 0.5) return false;
        with_normal += a == b;
      }
    return with_normal >= 2;
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

  void index_incident_cells(const SkinDefects& defects) {
    incident_.clear();
    for (const Edge& e : defects.edges)
      for (Index v : e) incident_[v];
    for (Index v : defects.vertices) incident_[v];
    for (Index c = 0; c < count_; ++c)
      for (Index v : tet(c))
        if (const auto at = incident_.find(v); at != incident_.end()) at->second.push_back(c);
  }
  CellList around_edge(const Edge& e) const {
    CellList ring;
    for (Index c : incident_.at(e[0]))
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
      Real cost = 0;
      for (Index c : g)
        cost += shape_of(tet(c), samples_.X).volume *
                (verdict_[std::size_t(c)] == Verdict::out ? 4 : 1);
      if (!is_kept(g.front()) && touches_hull(g)) cost *= 2;
      if (cost < best_cost) {
        best_cost = cost;
        best = &g;
      }
    }
    if (!best) return 0;
    const bool keep = !is_kept(best->front());
    for (Index c : *best) {
      kept_[std::size_t(c)] = keep;
      changed_vertices_.insert(tet(c).begin(), tet(c).end());
    }
    return int(best->size());
  }
  bool touches_hull(const CellList& g) const {
    return std::any_of(g.begin(), g.end(), [&](Index c) {
      const auto& n = cells_.neighbours[std::size_t(c)];
      return std::find(n.begin(), n.end(), -1) != n.end();
    });
  }
  bool loses_sample(const CellList& g) const {
    std::unordered_set<Index> vertices;
    for (Index c : g) vertices.insert(tet(c).begin(), tet(c).end());
    // Exact only for the indexed vertices; the others are checked over all tets once, at the end.
    return std::any_of(vertices.begin(), vertices.end(), [&](Index v) {
      const auto at = incident_.find(v);
      return at != incident_.end() &&
             std::all_of(at->second.begin(), at->second.end(), [&](Index c) {
               return !is_kept(c) || std::find(g.begin(), g.end(), c) != g.end();
             });
    });
  }

  const DelaunayCells& cells_;
  const Samples& samples_;
  Index count_;
  std::vector<Verdict> verdict_;
  std::vector<char> kept_;
  std::unordered_map<Index, CellList> incident_;
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
