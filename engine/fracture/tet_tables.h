// What never changes about the tets of a model: edges, neighbours and the skin, laid out for the
// per-frame work.
#pragma once

#include "engine/core/types.h"
#include "engine/scene/model.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace rend {

/// A tet around an edge and the local number of the edge in it.
struct TetEdge {
  Index tet;
  int edge;
};

/// Tets have their vertices sorted (see tet_templates.h) and are sorted themselves; edges are
/// stored once, at their lower end, and a tet names its edges by their places in the rows of its
/// vertices. What lies around an edge or across a face is found in the short lists of the tets of
/// its lowest vertex. Where several fans of tets share nothing but an edge, each fan has an edge
/// record of its own, and where the skin only touches itself in a particle, each sheet has a skin
/// vertex of its own: the surface stays a 2-manifold.
struct TetTables {
  /// @throws Error at `model` when a tet has a bad index or no volume, a particle has more than
  /// 65535 edges, or the skin is not the boundary.
  explicit TetTables(const Model& model);

  Index particle_count() const { return static_cast<Index>(X.size()); }
  Index edge_count() const { return static_cast<Index>(edge_to.size()); }
  Index tet_count() const { return static_cast<Index>(tet_lowest.size()); }
  Index skin_count() const { return static_cast<Index>(skin.size()); }

  /// Vertices of a tet, ascending.
  Tet corners(Index t) const {
    const auto& place = tet_place[t];
    const Index a = tet_lowest[t] & ~inside_out, row = edge_row[a];
    return {a, edge_to[row + place[0]], edge_to[row + place[1]], edge_to[row + place[2]]};
  }
  /// Edges of a tet, in the order of tet_templates.h.
  std::array<Index, 6> edges(Index t) const {
    const auto& place = tet_place[t];
    const Index row = edge_row[tet_lowest[t] & ~inside_out];
    const Index ab = row + place[0], ac = row + place[1];
    const Index row_b = edge_row[edge_to[ab]];
    return {ab,
            ac,
            row + place[2],
            row_b + place[3],
            row_b + place[4],
            edge_row[edge_to[ac]] + place[5]};
  }
  /// Whether sorting its vertices turned a tet inside out.
  bool negative(Index t) const { return (tet_lowest[t] & inside_out) != 0; }

  /// Ends of an edge, lower particle first. O(log #P).
  Edge edge(Index e) const;
  /// All tets around an edge, whose lower end is `lower`; appended to `out` after clearing it.
  void ring(Index e, Index lower, std::vector<TetEdge>& out) const;
  /// The other tet at face `f` of tet `t`, with the number of the face in it; -1 at the skin.
  struct TetFace {
    Index tet;
    int face;
  };
  TetFace across(Index t, int f) const;
  /// Number of the skin face that is face `f` of tet `t`, or -1. O(1) away from the skin.
  Index skin_face(Index t, int f) const;
  double bytes_per_particle() const;

  std::vector<Vec3> X;  ///< #P rest positions [m]
  std::vector<Index> edge_row,
      edge_to;  ///< half CSR: edges from p are [edge_row[p], edge_row[p+1])
  static constexpr Index inside_out = std::numeric_limits<Index>::min();  ///< the sign bit
  std::vector<Index> tet_lowest;  ///< first vertex and the bit above; the others are ends of edges
  /// Edges of a tet as places in rows: ab ac ad in the row of a, bc bd in that of b, cd in that of
  /// c.
  std::vector<std::array<std::uint16_t, 6>> tet_place;
  /// Tets by their first, second and third vertex; those by the first are numbered so.
  std::vector<Index> first_row, second_row, third_row, by_second, by_third;
  std::vector<bool> tet_on_skin;   ///< whether a tet has a face on the skin
  std::vector<bool> edge_on_skin;  ///< whether an edge bounds a skin face

  struct SkinFace {
    Index tet;
    int face;
    bool flip;                    ///< outward order of the sorted corners is (0, 2, 1)
    std::array<Index, 3> vertex;  ///< skin vertex of each sorted corner
  };
  std::vector<SkinFace> skin;        ///< in the order of Model::skin
  std::vector<Index> skin_by_tet;    ///< skin faces in the order of their tets
  std::vector<Triangle> skin_uncut;  ///< Model::skin in skin vertices, order of corners kept
  std::vector<Index> skin_particle;  ///< particle of each skin vertex
  std::vector<Real> mean_edge;       ///< one per body [m]
  std::vector<std::uint16_t> body;   ///< #P

 private:
  using TetEdges = std::vector<std::array<Index, 6>>;
  std::vector<Tet> sort_tets(const Model& model);
  TetEdges build_edges(const std::vector<Tet>& tet);
  /// Neighbours across the faces of each tet, -1 where there is none.
  std::vector<std::array<Index, 4>> build_faces(const Model& model, const std::vector<Tet>& tet);
  void split_fans(TetEdges& edges, const std::vector<std::array<Index, 4>>& neighbour);
  void list_tets(const std::vector<Tet>& tet, const TetEdges& edges);
  void mark_skin();
  void build_skin(const Model& model);
  void measure(const Model& model);
};

}  // namespace rend
