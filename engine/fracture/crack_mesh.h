// The broken edges of a tet mesh and the cut surface they make, kept up to date tet by tet.
#pragma once

#include "engine/fracture/tet_tables.h"
#include "engine/fracture/tet_templates.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace rend {

/// An edge that broke: copies 2k and 2k+1 of its middle are not shared, one belongs to each end
/// (lower first).
struct BrokenEdge {
  Index edge;
  Index frame;  ///< of the snapshot that broke it
  Index copy;   ///< vertex copy of the lower end; the other one is copy + 1
  Real t;       ///< where the crack crosses the edge, from the lower end [-]
};

/// A vertex added by the cut. The copies of one simplex share a node, that is a rest position, so
/// both faces of a crack are congruent; each is carried by the particles of its component.
struct VertexCopy {
  Index node = -1;
  std::array<Index, 4> member{-1, -1, -1, -1};  ///< particles, filled from the front
  bool tip =
      false;  ///< centre of a face that is still one component: barycentre, no rotation needed
  bool on_skin = false;
};

/// Corner ids: skin vertices first, then copies.
using CutTriangle = std::array<Index, 3>;

/// Every copy is keyed by its simplex and the representative of its component and keeps its number
/// as long as that component exists; only tets with a newly broken edge are cut again. Cost:
/// O(#newly broken edges).
class CrackMesh {
 public:
  explicit CrackMesh(const TetTables& tables);

  /// Breaks edges that are not broken yet; ids in ascending order for reproducible numbering.
  void break_edges(std::span<const Index> edges, Index frame);
  bool broken(Index edge) const { return std::signbit(edge_length2_[edge]); }
  /// #E squared rest lengths [m2]; negative or NaN once broken.
  const std::vector<float>& edge_length2() const { return edge_length2_; }
  /// Particles that p shares an unbroken edge with, and those it was torn from.
  std::span<const Index> linked(Index p) const {
    return {link_.data() + link_row_[p], static_cast<std::size_t>(link_count_[p])};
  }
  std::span<const Index> torn(Index p) const {
    return {link_.data() + link_row_[p] + link_count_[p], link_.data() + link_row_[p + 1]};
  }
  /// -1 for an edge that is not broken.
  Index record_of_edge(Index edge) const {
    return broken(edge)
               ? static_cast<Index>(std::bit_cast<std::uint32_t>(edge_length2_[edge]) - record_bits)
               : -1;
  }
  /// Ends of a broken edge, lower particle first.
  Edge ends(const BrokenEdge& b) const {
    return {copies_[b.copy].member[0], copies_[b.copy + 1].member[0]};
  }
  /// A particle in whose matter a corner lies.
  Index particle_of(Index corner) const {
    const auto skin_vertices = static_cast<Index>(tables_->skin_particle.size());
    return corner < skin_vertices ? tables_->skin_particle[corner]
                                  : copies_[corner - skin_vertices].member[0];
  }

  /// Lets the crack cross the edge of a record at share t from its lower end.
  void place_middle(Index record, Real t);
  /// Puts centres of faces and tets that the last call of break_edges has made, where cracks
  /// branch, between the middles around them. Older ones stay.
  void place_centres();
  /// Records of tets whose centre the last call of break_edges has made.
  const std::vector<Index>& born_centres() const { return born_centres_; }
  /// Where the centre of a tet with branching cracks lies at rest.
  const Vec3& centre(Index record) const {
    return nodes_[copies_[centres_[cracked_[record].centre][0]].node];
  }
  void place_centre(Index record, const Vec3& rest) {
    nodes_[copies_[centres_[cracked_[record].centre][0]].node] = rest;
  }

  struct Range {
    Index first = 0, count = 0;
  };
  struct CrackedTet {
    Index tet;
    Range triangles;
    std::array<Index, 4> face;  ///< face record or -1
    Index centre;               ///< centre record or -1
  };
  struct SkinCut {
    Range triangles;  ///< count 0: uncut
  };

  const TetTables& tables() const { return *tables_; }
  const std::vector<BrokenEdge>& broken_edges() const { return broken_; }
  const std::vector<VertexCopy>& copies() const { return copies_; }
  const std::vector<Vec3>& nodes() const { return nodes_; }
  const std::vector<CrackedTet>& cracked() const { return cracked_; }
  const std::vector<SkinCut>& skin_cuts() const { return skin_; }
  const std::vector<CutTriangle>& triangles() const { return triangles_; }
  const std::vector<Index>& free_copies() const { return free_copies_; }
  /// Particles that carry copies by rotation, ascending.
  const std::vector<Index>& near_crack() const { return near_; }
  Index cracked_of_tet(Index tet) const { return cracked_of_tet_[tet]; }
  /// Records of tets whose mask grew in the last call of break_edges.
  const std::vector<Index>& changed() const { return changed_; }
  std::span<const CutTriangle> triangles_of(const Range& r) const {
    return {triangles_.data() + r.first, static_cast<std::size_t>(r.count)};
  }
  int mask(Index tet) const { return mask_[tet]; }
  double bytes() const;

 private:
  struct FaceRecord {
    int mask = 0;
    std::array<Index, 3> copy{-1, -1, -1};
  };
  using CentreRecord = std::array<Index, 4>;

  void build_links();
  void unlink(Index from, Index to);
  void open_edge(Index edge, Index frame);
  Index cracked_record(Index tet);
  Index face_record(CrackedTet& cracked, int face);
  void release_tips(Index record);
  void update_faces(Index record);
  void update_centre(Index record);
  void emit_tet(CrackedTet& cracked);
  void emit_skin(Index skin_face);
  Index corner_id(const CrackedTet& cracked, const std::array<Index, 6>& edges,
                  CornerCode code) const;
  Index middle_id(Index edge, int side) const;
  Index add_copy(Index node, bool on_skin);
  Index add_node(const Vec3& rest);
  void mark_near(Index particle);
  void reserve_triangles(Range& range, Index count);
  void compact_triangles();

  // A broken edge keeps its record in the place of its length: a negative number of normal size.
  static constexpr std::uint32_t record_bits = 0xc0000000u;

  const TetTables* tables_;
  std::vector<float> edge_length2_;
  std::vector<Index> link_row_, link_;  ///< full CSR of neighbours, unbroken ones first
  std::vector<Index> link_count_;       ///< unbroken ones
  std::vector<BrokenEdge> broken_;
  std::vector<std::uint8_t> mask_;
  std::vector<Index> cracked_of_tet_;
  std::vector<CrackedTet> cracked_;
  std::vector<FaceRecord> faces_;
  std::vector<CentreRecord> centres_;
  std::vector<VertexCopy> copies_;
  std::vector<Vec3> nodes_;
  std::vector<Index> free_copies_, free_nodes_;
  std::vector<CutTriangle> triangles_;
  Index live_triangles_ = 0;
  std::vector<SkinCut> skin_;
  std::vector<Index> changed_, born_centres_;
  std::vector<std::uint8_t> is_near_;
  std::vector<Index> near_;
  std::vector<TetEdge> ring_;
};

}  // namespace rend
