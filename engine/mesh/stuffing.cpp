// Lattice, warp, cut.
#include "engine/mesh/stuffing.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mesh/clip.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace rend {

namespace {

// A lattice point moves to a crossing nearer than this share of the edge; the values for which
// Labelle and Shewchuk prove the angles of an isotropic lattice.
constexpr Real kWarpLong = 0.24999, kWarpShort = 0.41189;

struct Crossing {
  Index inside, outside;
  Vec3 x;
  Real share;  // of the edge, from the inner end
  bool is_long;
};

class Stuffing {
 public:
  Stuffing(const Solid& solid, Real pitch) : solid_(solid) {
    const Vec3 size = solid.bounds().size();
    for (int a = 0; a < 3; ++a) {
      cells_[a] = std::max(1, static_cast<int>(std::lround(size[a] / pitch)));
      pitch_[a] = size[a] / cells_[a];
    }
    place_points();
    add_lattice_tets();
    find_crossings();
    warp();
    cut();
  }

  Body take() {
    Body body;
    std::vector<Index> index(X_.size(), -1);
    for (Tet& t : tets_)
      for (Index& v : t) {
        Index& to = index[static_cast<std::size_t>(v)];
        if (to < 0) {
          to = static_cast<Index>(body.X.size());
          body.X.push_back(X_[static_cast<std::size_t>(v)]);
        }
        v = to;
      }
    body.tets = std::move(tets_);
    return body;
  }

 private:
  // Corners first, then centres, with one layer of both around the bounding box.
  void place_points() {
    corner_ = cells_ + Vec3i::Constant(3);
    centre_ = cells_ + Vec3i::Constant(2);
    const Vec3 low = solid_.bounds().low - pitch_;
    for (int which = 0; which < 2; ++which) {
      const Vec3i& n = which == 0 ? corner_ : centre_;
      for (int i = 0; i < n[0]; ++i)
        for (int j = 0; j < n[1]; ++j)
          for (int k = 0; k < n[2]; ++k)
            X_.push_back(low + pitch_.cwiseProduct(Vec3(i, j, k) + Vec3::Constant(0.5 * which)));
    }
    phi_.resize(X_.size());
    const Real zero = 1e-9 * pitch_.minCoeff();
    parallel_for(static_cast<Index>(X_.size()), 256, [&](Index p) {
      const auto i = static_cast<std::size_t>(p);
      phi_[i] = solid_.distance(X_[i]);
      if (std::abs(phi_[i]) < zero) phi_[i] = 0;
    });
  }

  Index corner(int i, int j, int k) const { return (i * corner_[1] + j) * corner_[2] + k; }
  Index centre(int i, int j, int k) const {
    return corner_.prod() + (i * centre_[1] + j) * centre_[2] + k;
  }

  // Two neighbouring centres and an edge of the face between them make a tet.
  void add_lattice_tets() {
    for (int i = 0; i < centre_[0]; ++i)
      for (int j = 0; j < centre_[1]; ++j)
        for (int k = 0; k < centre_[2]; ++k)
          for (int a = 0; a < 3; ++a) {
            Vec3i at(i, j, k), next = at;
            if (++next[a] >= centre_[a]) continue;
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            // Corners of the face go round the axis.
            Index ring[4];
            for (int s = 0; s < 4; ++s) {
              Vec3i v = next;
              v[b] += s == 1 || s == 2;
              v[c] += s >= 2;
              ring[s] = corner(v[0], v[1], v[2]);
            }
            for (int s = 0; s < 4; ++s)
              add_lattice_tet({centre(at[0], at[1], at[2]), centre(next[0], next[1], next[2]),
                               ring[s], ring[(s + 1) % 4]});
          }
  }
  void add_lattice_tet(const Tet& t) {
    const bool any_inside = std::any_of(
        t.begin(), t.end(), [&](Index v) { return phi_[static_cast<std::size_t>(v)] < 0; });
    if (any_inside) lattice_tets_.push_back(t);
  }

  static std::uint64_t edge_key(Index a, Index b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
           static_cast<std::uint64_t>(std::max(a, b));
  }

  void find_crossings() {
    const Index corners = corner_.prod();
    for (const Tet& t : lattice_tets_)
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b) {
          const Real pa = phi_[static_cast<std::size_t>(t[a])],
                     pb = phi_[static_cast<std::size_t>(t[b])];
          if (!(pa * pb < 0)) continue;
          if (!crossing_of_.emplace(edge_key(t[a], t[b]), crossings_.size()).second) continue;
          crossings_.push_back({pa < 0 ? t[a] : t[b], pa < 0 ? t[b] : t[a], Vec3::Zero(), 0,
                                (t[a] < corners) == (t[b] < corners)});
        }
    parallel_for(static_cast<Index>(crossings_.size()), 64, [&](Index n) {
      Crossing& c = crossings_[static_cast<std::size_t>(n)];
      const Vec3 from = X_[static_cast<std::size_t>(c.inside)],
                 to = X_[static_cast<std::size_t>(c.outside)];
      Real low = 0, high = 1;
      for (int i = 0; i < 30; ++i) {
        const Real middle = 0.5 * (low + high);
        (solid_.distance(from + middle * (to - from)) < 0 ? low : high) = middle;
      }
      c.share = 0.5 * (low + high);
      c.x = from + c.share * (to - from);
    });
  }

  void warp() {
    std::vector<std::vector<std::size_t>> at(X_.size());
    for (std::size_t n = 0; n < crossings_.size(); ++n) {
      at[static_cast<std::size_t>(crossings_[n].inside)].push_back(n);
      at[static_cast<std::size_t>(crossings_[n].outside)].push_back(n);
    }
    for (std::size_t v = 0; v < X_.size(); ++v) {
      const Crossing* nearest = nullptr;
      Real least = 1e300;
      for (std::size_t n : at[v]) {
        const Crossing& c = crossings_[n];
        const bool inner = static_cast<std::size_t>(c.inside) == v;
        const auto other = static_cast<std::size_t>(inner ? c.outside : c.inside);
        if (phi_[other] == 0) continue;
        const Real share = inner ? c.share : 1 - c.share;
        if (share >= (c.is_long ? kWarpLong : kWarpShort)) continue;
        const Real distance = (c.x - X_[v]).norm();
        if (distance < least) {
          least = distance;
          nearest = &c;
        }
      }
      if (!nearest) continue;
      X_[v] = nearest->x;
      phi_[v] = 0;
    }
  }

  Index crossing_point(Index a, Index b) {
    const std::size_t n = crossing_of_.at(edge_key(a, b));
    const auto [it, is_new] = point_of_.emplace(n, static_cast<Index>(X_.size()));
    if (is_new) X_.push_back(crossings_[n].x);
    return it->second;
  }

  void add(Index a, Index b, Index c, Index d) {
    const Vec3& o = X_[static_cast<std::size_t>(a)];
    const Vec3 u = X_[static_cast<std::size_t>(b)] - o, v = X_[static_cast<std::size_t>(c)] - o,
               w = X_[static_cast<std::size_t>(d)] - o;
    const Real volume = u.dot(v.cross(w));
    if (volume > 0)
      tets_.push_back({a, b, c, d});
    else
      tets_.push_back({a, b, d, c});
  }

  // Quad a b c d and an apex; the diagonal starts at the lowest vertex of the quad.
  void add_pyramid(Index a, Index b, Index c, Index d, Index apex) {
    if (std::min(a, c) < std::min(b, d)) {
      add(a, b, c, apex);
      add(a, c, d, apex);
    } else {
      add(b, c, d, apex);
      add(b, d, a, apex);
    }
  }
  // Triangles v0 v1 v2 and v3 v4 v5 with edges v0 v3, v1 v4, v2 v5: the tet of the lowest vertex
  // and the far triangle, and its pyramid over the quad that it does not touch.
  void add_prism(std::array<Index, 6> v) {
    const auto lowest = std::min_element(v.begin(), v.end()) - v.begin();
    if (lowest >= 3) std::swap_ranges(v.begin(), v.begin() + 3, v.begin() + 3);
    const auto turn = lowest % 3;
    std::rotate(v.begin(), v.begin() + turn, v.begin() + 3);
    std::rotate(v.begin() + 3, v.begin() + 3 + turn, v.end());
    add(v[0], v[3], v[4], v[5]);
    add_pyramid(v[1], v[2], v[5], v[4], v[0]);
  }

  void cut() {
    for (const Tet& t : lattice_tets_) {
      std::vector<Index> in, on, out;
      for (Index v : t) {
        const Real phi = phi_[static_cast<std::size_t>(v)];
        (phi < 0 ? in : phi > 0 ? out : on).push_back(v);
      }
      const auto at = [&](std::size_t i, std::size_t o) { return crossing_point(in[i], out[o]); };
      if (in.empty()) continue;
      if (out.empty()) {
        add(t[0], t[1], t[2], t[3]);
      } else if (in.size() == 1) {
        std::vector<Index> base = on;
        for (std::size_t o = 0; o < out.size(); ++o) base.push_back(at(0, o));
        add(in[0], base[0], base[1], base[2]);
      } else if (in.size() == 2 && out.size() == 1) {
        add_pyramid(in[0], in[1], at(1, 0), at(0, 0), on[0]);
      } else if (in.size() == 2) {
        add_prism({in[0], at(0, 0), at(0, 1), in[1], at(1, 0), at(1, 1)});
      } else {
        add_prism({in[0], in[1], in[2], at(0, 0), at(1, 0), at(2, 0)});
      }
    }
  }

  const Solid& solid_;
  Vec3i cells_, corner_, centre_;
  Vec3 pitch_;
  std::vector<Vec3> X_;
  std::vector<Real> phi_;
  std::vector<Tet> lattice_tets_, tets_;
  std::vector<Crossing> crossings_;
  std::unordered_map<std::uint64_t, std::size_t> crossing_of_;
  std::unordered_map<std::size_t, Index> point_of_;
};

}  // namespace

TetQuality tet_quality(const Tet& tet, const std::vector<Vec3>& X) {
  Vec3 normal[4];  // outward, of the face opposite each corner
  Real altitude = 1e300;
  for (int k = 0; k < 4; ++k) {
    const Triangle f = outward_face(tet, k);
    const Vec3& o = X[static_cast<std::size_t>(f[0])];
    normal[k] = (X[static_cast<std::size_t>(f[1])] - o)
                    .cross(X[static_cast<std::size_t>(f[2])] - o)
                    .normalized();
    altitude = std::min(
        altitude, normal[k].dot(o - X[static_cast<std::size_t>(tet[static_cast<std::size_t>(k)])]));
  }
  Real widest = -1;
  for (int a = 0; a < 4; ++a)
    for (int b = a + 1; b < 4; ++b) widest = std::max(widest, -normal[a].dot(normal[b]));
  return {altitude, std::acos(std::clamp(widest, -1.0, 1.0))};
}

Body stuff_body(const Solid& solid, Real count) {
  // Two points a cell; surface points come on top, so the pitch is corrected by what came out.
  Real pitch = std::cbrt(2 * solid.volume() / count);
  Body body;
  for (int round = 0; round < 4; ++round) {
    body = Stuffing(solid, pitch).take();
    if (body.tets.empty()) break;
    const Real ratio = static_cast<Real>(body.X.size()) / count;
    if (std::abs(ratio - 1) < 0.05) break;
    pitch *= std::cbrt(ratio);
  }
  if (body.tets.empty())
    throw Error("", "no tetrahedron fits inside; use a smaller grid.dx or more particles_per_cell");
  body.skin = skin_of(body.tets);
  const SkinDefects defects = find_skin_defects(body.skin);
  const std::size_t open = defects.edges.size() + defects.vertices.size();
  if (open > 0)
    body.notes.push_back(
        fmt::format("{} places of the surface are not manifold at this particle spacing", open));
  body.volume.assign(body.X.size(), 0);
  Real total = 0;
  for (const Tet& t : body.tets) {
    const Vec3& o = body.X[static_cast<std::size_t>(t[0])];
    const Real v = (body.X[static_cast<std::size_t>(t[1])] - o)
                       .dot((body.X[static_cast<std::size_t>(t[2])] - o)
                                .cross(body.X[static_cast<std::size_t>(t[3])] - o)) /
                   24;
    for (Index i : t) body.volume[static_cast<std::size_t>(i)] += v;
    total += 4 * v;
  }
  for (Real& v : body.volume) v *= solid.volume() / total;
  body.crease.assign(body.X.size(), 0);
  return body;
}

}  // namespace rend
