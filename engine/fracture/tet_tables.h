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

/// Tets have their vertices sorted (see tet_templates.h); edges are stored once, at their lower
/// end. Where several fans of tets share nothing but an edge, each fan has an edge record of its
/// own, and where the skin only touches itself in a particle, each sheet has a skin vertex of its
/// own: the surface stays a 2-manifold.
struct TetTables {
  /// @throws Error at `model` when a tet has a bad index or no volume, or the skin is not the
  /// boundary.
  explicit TetTables(const Model& model);

  Index particle_count() const { return static_cast<Index>(X.size()); }
  Index edge_count() const { return static_cast<Index>(edge_to.size()); }
  Index tet_count() const { return static_cast<Index>(tet_edge.size()); }
  /// Vertices of a tet, ascending.
  Tet corners(Index t) const {
    const auto& e = tet_edge[t];
    return {tet_lowest[t] & ~inside_out, edge_to[e[0]], edge_to[e[1]], edge_to[e[2]]};
  }
  /// Whether sorting its vertices turned a tet inside out.
  bool negative(Index t) const { return (tet_lowest[t] & inside_out) != 0; }
  Index skin_count() const { return static_cast<Index>(skin.size()); }

  Edge edge(Index e) const;  ///< its ends, lower particle first
  /// All tets around an edge, in order; appended to `out` after clearing it.
  void ring(Index e, std::vector<TetEdge>& out) const;
  double bytes_per_particle() const;

  std::vector<Vec3> X;  ///< #P rest positions [m]
  std::vector<Index> edge_row,
      edge_to;                  ///< half CSR: edges from p are [edge_row[p], edge_row[p+1])
  std::vector<Index> edge_tet;  ///< #E one tet of the fan
  static constexpr Index inside_out = std::numeric_limits<Index>::min();  ///< the sign bit
  std::vector<Index> tet_lowest;  ///< first vertex and the bit above; the others are ends of edges
  std::vector<std::array<Index, 6>> tet_edge;
  std::vector<std::array<Index, 4>>
      tet_face;  ///< neighbour across the face, or -1 - index into skin

  struct SkinFace {
    Index tet;
    int face;
    bool flip;                    ///< outward order of the sorted corners is (0, 2, 1)
    std::array<Index, 3> vertex;  ///< skin vertex of each sorted corner
  };
  std::vector<SkinFace> skin;        ///< in the order of Model::skin
  std::vector<Triangle> skin_uncut;  ///< Model::skin in skin vertices, order of corners kept
  std::vector<Index> skin_particle;  ///< particle of each skin vertex
  std::vector<Real> mean_edge;       ///< one per body [m]
  std::vector<std::uint16_t> body;   ///< #P

 private:
  std::vector<Tet> sort_tets(const Model& model);
  void build_edges(const std::vector<Tet>& tet);
  void build_faces(const Model& model, const std::vector<Tet>& tet);
  void split_fans();
  void build_skin(const Model& model);
  void measure(const Model& model);
};

}  // namespace rend
