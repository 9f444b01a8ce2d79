// Cuts only what changed; everything is done in the order of edge ids so that numbering never
// depends on threads.
#include "engine/fracture/crack_mesh.h"

#include <algorithm>
#include <bit>

namespace rend {

namespace {

// Cyclic edges of a face (corner k to corner k+1) as edge bits of the face (01 02 12).
constexpr int cyclic_edge[3] = {0, 2, 1};
constexpr std::uint8_t changed_bit = 64;

}  // namespace

CrackMesh::CrackMesh(const TetTables& tables)
    : tables_(&tables),
      mask_(tables.tet_lowest.size(), 0),
      cracked_of_tet_(tables.tet_lowest.size(), -1),
      skin_(tables.skin.size()),
      is_near_(tables.X.size(), 0) {
  build_links();
}

void CrackMesh::build_links() {
  const TetTables& t = *tables_;
  const Index n = t.particle_count();
  edge_length2_.resize(t.edge_to.size());
  link_row_.assign(n + 1, 0);
  // Edge records of several fans between the same two particles are one link.
  const auto each_link = [&](auto&& visit) {
    for (Index p = 0; p < n; ++p)
      for (Index e = t.edge_row[p]; e < t.edge_row[p + 1]; ++e)
        if (e == t.edge_row[p] || t.edge_to[e] != t.edge_to[e - 1]) visit(p, t.edge_to[e]);
  };
  each_link([&](Index a, Index b) { ++link_row_[a + 1], ++link_row_[b + 1]; });
  for (Index p = 0; p < n; ++p) link_row_[p + 1] += link_row_[p];
  link_.resize(link_row_[n]);
  link_count_.assign(n, 0);
  each_link([&](Index a, Index b) { link_[link_row_[b] + link_count_[b]++] = a; });
  each_link([&](Index a, Index b) { link_[link_row_[a] + link_count_[a]++] = b; });
  for (Index p = 0; p < n; ++p)
    for (Index e = t.edge_row[p]; e < t.edge_row[p + 1]; ++e) {
      // The edge of a sliver may be so short that any strain looks like a break.
      const Real shortest = 0.05 * t.mean_edge[t.body[p]];
      const Real length2 = (t.X[t.edge_to[e]] - t.X[p]).squaredNorm();
      edge_length2_[e] = static_cast<float>(std::max(length2, shortest * shortest));
    }
}

void CrackMesh::unlink(Index from, Index to) {
  const auto begin = link_.begin() + link_row_[from], end = begin + link_count_[from];
  const auto at = std::find(begin, end, to);
  if (at == end) return;
  std::rotate(at, at + 1, end);
  --link_count_[from];
}

Index CrackMesh::add_node(const Vec3& rest) {
  if (!free_nodes_.empty()) {
    const Index node = free_nodes_.back();
    free_nodes_.pop_back();
    nodes_[node] = rest;
    return node;
  }
  nodes_.push_back(rest);
  return static_cast<Index>(nodes_.size()) - 1;
}

Index CrackMesh::add_copy(Index node, bool on_skin) {
  VertexCopy copy;
  copy.node = node;
  copy.on_skin = on_skin;
  if (!free_copies_.empty()) {
    const Index id = free_copies_.back();
    free_copies_.pop_back();
    copies_[id] = copy;
    return id;
  }
  copies_.push_back(copy);
  return static_cast<Index>(copies_.size()) - 1;
}

void CrackMesh::mark_near(Index particle) {
  if (is_near_[particle]) return;
  is_near_[particle] = 1;
  near_.push_back(particle);
}

void CrackMesh::break_edges(std::span<const Index> edges, Index frame) {
  changed_.clear();
  born_centres_.clear();
  const auto known_near = static_cast<std::ptrdiff_t>(near_.size());
  for (Index e : edges)
    if (!broken(e)) open_edge(e, frame);
  // Ends of tips are given back before new centres are made, so that their numbers are used again
  // at once.
  for (Index r : changed_) release_tips(r);
  for (Index r : changed_) {
    update_faces(r);
    CrackedTet& cracked = cracked_[r];
    mask_[cracked.tet] &= static_cast<std::uint8_t>(~changed_bit);
    if (tet_templates().tet[mask_[cracked.tet]].needs_centre) update_centre(r);
  }
  for (Index r : changed_) {
    emit_tet(cracked_[r]);
    for (int f = 0; f < 4; ++f)
      if (const Index face = tables_->skin_face(cracked_[r].tet, f); face >= 0) emit_skin(face);
  }
  // Ascending, so that every frame walks through the particles in the order of their memory.
  std::sort(near_.begin() + known_near, near_.end());
  std::inplace_merge(near_.begin(), near_.begin() + known_near, near_.end());
  if (triangles_.size() > 4096 && 2 * static_cast<std::size_t>(live_triangles_) < triangles_.size())
    compact_triangles();
}

void CrackMesh::open_edge(Index edge, Index frame) {
  const Edge end = tables_->edge(edge);
  tables_->ring(edge, end[0], ring_);
  // The two copies are neighbours in memory, so they never come from the free list.
  const Index node = add_node(0.5 * (tables_->X[end[0]] + tables_->X[end[1]]));
  const Index copy = static_cast<Index>(copies_.size());
  for (Index particle : end) {
    VertexCopy& c = copies_.emplace_back();
    c.node = node;
    c.member[0] = particle;
    c.on_skin = tables_->edge_on_skin[edge];
    mark_near(particle);
  }
  unlink(end[0], end[1]);
  unlink(end[1], end[0]);
  edge_length2_[edge] =
      std::bit_cast<float>(record_bits + static_cast<std::uint32_t>(broken_.size()));
  broken_.push_back({edge, frame, copy, 0.5});
  for (const TetEdge& around : ring_) {
    const Index record = cracked_record(around.tet);
    std::uint8_t& mask = mask_[around.tet];
    if (!(mask & changed_bit)) changed_.push_back(record);
    mask |= static_cast<std::uint8_t>(changed_bit | 1 << around.edge);
  }
}

Index CrackMesh::cracked_record(Index tet) {
  Index& record = cracked_of_tet_[tet];
  if (record < 0) {
    record = static_cast<Index>(cracked_.size());
    cracked_.push_back({tet, {}, {-1, -1, -1, -1}, -1});
  }
  return record;
}

Index CrackMesh::face_record(CrackedTet& cracked, int face) {
  Index& record = cracked.face[face];
  if (record >= 0) return record;
  record = static_cast<Index>(faces_.size());
  faces_.emplace_back();
  // Both tets of a broken edge are cracked, so the other one has a record as well.
  const auto other = tables_->across(cracked.tet, face);
  if (other.tet >= 0) cracked_[cracked_of_tet_[other.tet]].face[other.face] = record;
  return record;
}

void CrackMesh::release_tips(Index r) {
  CrackedTet& cracked = cracked_[r];
  for (int f = 0; f < 4; ++f) {
    if (cracked.face[f] < 0) continue;
    FaceRecord& face = faces_[cracked.face[f]];
    if (std::popcount(static_cast<unsigned>(face_mask(mask_[cracked.tet], f))) != 2) continue;
    if (face.copy[0] < 0) continue;
    free_nodes_.push_back(copies_[face.copy[0]].node);
    free_copies_.push_back(face.copy[0]);
    copies_[face.copy[0]].node = -1;
    face.copy = {-1, -1, -1};
  }
}

void CrackMesh::update_faces(Index r) {
  for (int f = 0; f < 4; ++f) {
    const int mask = face_mask(mask_[cracked_[r].tet], f);
    const int broken_count = std::popcount(static_cast<unsigned>(mask));
    // Middle to middle, a face needs nothing of its own.
    if (broken_count == 0 || (broken_count == 2 && cracked_[r].face[f] < 0)) continue;
    FaceRecord& face = faces_[face_record(cracked_[r], f)];
    if (face.mask == mask) continue;
    face.mask = mask;
    if (broken_count == 2) continue;
    const Index tet = cracked_[r].tet;
    const Tet corner = tables_->corners(tet);
    std::array<Index, 3> v;
    for (int k = 0; k < 3; ++k) v[k] = corner[face_corners[f][k]];
    const Vec3 centre = (tables_->X[v[0]] + tables_->X[v[1]] + tables_->X[v[2]]) / 3;
    const bool on_skin = tables_->skin_face(tet, f) >= 0;
    if (face.copy[0] < 0) face.copy[0] = add_copy(add_node(centre), on_skin);
    VertexCopy& first = copies_[face.copy[0]];
    first.tip = broken_count == 1;
    if (first.tip) {
      first.member = {v[0], v[1], v[2], -1};
      continue;
    }
    first.member = {v[0], -1, -1, -1};
    const Index node = first.node;
    for (int k = 1; k < 3; ++k) {
      face.copy[k] = add_copy(node, on_skin);
      copies_[face.copy[k]].member[0] = v[k];
    }
  }
}

void CrackMesh::update_centre(Index record) {
  CrackedTet& cracked = cracked_[record];
  const Tet v = tables_->corners(cracked.tet);
  if (cracked.centre < 0) {
    cracked.centre = static_cast<Index>(centres_.size());
    centres_.push_back({-1, -1, -1, -1});
    born_centres_.push_back(record);
  }
  CentreRecord& centre = centres_[cracked.centre];
  const auto& component = tet_templates().tet_component[mask_[cracked.tet]];
  for (int k = 0; k < 4; ++k) {
    mark_near(v[k]);
    if (component[k] != k) continue;
    if (centre[k] < 0) {
      const Vec3 middle =
          0.25 * (tables_->X[v[0]] + tables_->X[v[1]] + tables_->X[v[2]] + tables_->X[v[3]]);
      const Index node = k > 0 ? copies_[centre[0]].node : add_node(middle);
      centre[k] = add_copy(node, false);
    }
    VertexCopy& copy = copies_[centre[k]];
    copy.member = {-1, -1, -1, -1};
    for (int j = 0, count = 0; j < 4; ++j)
      if (component[j] == k) copy.member[count++] = v[j];
  }
}

Index CrackMesh::middle_id(Index edge, int side) const {
  return static_cast<Index>(tables_->skin_particle.size()) + broken_[record_of_edge(edge)].copy +
         side;
}

Index CrackMesh::corner_id(const CrackedTet& cracked, const std::array<Index, 6>& edges,
                           CornerCode code) const {
  const auto skin_vertices = static_cast<Index>(tables_->skin_particle.size());
  if (code >= tet_code) return skin_vertices + centres_[cracked.centre][code - tet_code];
  if (code >= face_code)
    return skin_vertices +
           faces_[cracked.face[(code - face_code) / 3]].copy[(code - face_code) % 3];
  return middle_id(edges[code / 2], code % 2);
}

void CrackMesh::reserve_triangles(Range& range, Index count) {
  live_triangles_ += count - range.count;
  if (count > range.count) {
    range.first = static_cast<Index>(triangles_.size());
    triangles_.resize(triangles_.size() + count);
  }
  range.count = count;
}

void CrackMesh::compact_triangles() {
  std::vector<CutTriangle> packed;
  packed.reserve(static_cast<std::size_t>(live_triangles_));
  const auto move = [&](Range& range) {
    const auto begin = triangles_.begin() + range.first;
    range.first = static_cast<Index>(packed.size());
    packed.insert(packed.end(), begin, begin + range.count);
  };
  for (CrackedTet& cracked : cracked_) move(cracked.triangles);
  for (SkinCut& cut : skin_) move(cut.triangles);
  triangles_ = std::move(packed);
}

void CrackMesh::emit_tet(CrackedTet& cracked) {
  const TetTemplate& cut = tet_templates().tet[mask_[cracked.tet]];
  reserve_triangles(cracked.triangles, cut.triangle_count);
  std::array<Index, code_count> id;
  id.fill(-1);
  const auto edges = tables_->edges(cracked.tet);
  const bool negative = tables_->negative(cracked.tet);
  for (int k = 0; k < cut.triangle_count; ++k) {
    const auto& piece = cut.triangles[k];
    CutTriangle& triangle = triangles_[cracked.triangles.first + k];
    for (int c = 0; c < 3; ++c) {
      const CornerCode code = piece[negative && c ? 3 - c : c];
      if (id[code] < 0) id[code] = corner_id(cracked, edges, code);
      triangle[c] = id[code];
    }
  }
}

void CrackMesh::emit_skin(Index skin_face) {
  const auto& face = tables_->skin[skin_face];
  const int mask = face_mask(mask_[face.tet], face.face);
  if (mask == 0) return;
  const int* corner = face_corners[face.face];
  const int broken_count = std::popcount(static_cast<unsigned>(mask));
  Range& range = skin_[skin_face].triangles;
  reserve_triangles(range, broken_count == 1 ? 4 : broken_count == 2 ? 3 : 6);
  Index at = range.first;
  const auto add = [&](Index a, Index b, Index c) {
    if (face.flip) std::swap(b, c);
    triangles_[at++] = {a, b, c};
  };
  const auto edges = tables_->edges(face.tet);
  const auto middle = [&](int edge, int k) {
    const int local = face_edges[face.face][edge];
    return middle_id(edges[local], edge_ends[local][0] == corner[k] ? 0 : 1);
  };
  if (broken_count == 2) {
    int whole = 0;
    while (mask >> cyclic_edge[whole] & 1) ++whole;
    const int p = whole, q = (whole + 1) % 3, r = (whole + 2) % 3;
    const int qr = cyclic_edge[q], rp = cyclic_edge[r];
    add(face.vertex[r], middle(rp, r), middle(qr, r));
    add(face.vertex[p], face.vertex[q], middle(qr, q));
    add(face.vertex[p], middle(qr, q), middle(rp, p));
    return;
  }
  const FaceRecord& record = faces_[cracked_[cracked_of_tet_[face.tet]].face[face.face]];
  const auto skin_vertices = static_cast<Index>(tables_->skin_particle.size());
  for (int p = 0; p < 3; ++p) {
    const int q = (p + 1) % 3, edge = cyclic_edge[p];
    const auto& component = tet_templates().face_component[mask];
    const Index centre_p = skin_vertices + record.copy[component[p]];
    const Index centre_q = skin_vertices + record.copy[component[q]];
    if (mask >> edge & 1) {
      add(face.vertex[p], middle(edge, p), centre_p);
      add(middle(edge, q), face.vertex[q], centre_q);
    } else {
      add(face.vertex[p], face.vertex[q], centre_p);
    }
  }
}

void CrackMesh::place_middle(Index record, Real t) {
  BrokenEdge& b = broken_[record];
  b.t = t;
  const Edge end = ends(b);
  const Vec3 &from = tables_->X[end[0]], &to = tables_->X[end[1]];
  nodes_[copies_[b.copy].node] = from + t * (to - from);
}

void CrackMesh::place_centres() {
  const auto middle = [&](Index edge) -> const Vec3& {
    return nodes_[copies_[broken_[record_of_edge(edge)].copy].node];
  };
  // Between their middles, inside their simplex: no sub-tet can turn inside out.
  for (Index r : changed_) {
    const CrackedTet& cracked = cracked_[r];
    const auto edges = tables_->edges(cracked.tet);
    for (int f = 0; f < 4; ++f)
      if (face_mask(mask_[cracked.tet], f) == 7) {
        const int* e = face_edges[f];
        nodes_[copies_[faces_[cracked.face[f]].copy[0]].node] =
            (middle(edges[e[0]]) + middle(edges[e[1]]) + middle(edges[e[2]])) / 3;
      }
  }
  for (Index r : born_centres_) {
    const CrackedTet& cracked = cracked_[r];
    const auto edges = tables_->edges(cracked.tet);
    const int mask = mask_[cracked.tet];
    Vec3 sum = Vec3::Zero(), corners = Vec3::Zero();
    for (int e = 0; e < 6; ++e)
      if (mask >> e & 1) sum += middle(edges[e]);
    for (Index v : tables_->corners(cracked.tet)) corners += tables_->X[v];
    place_centre(r, 0.5 * (sum / std::popcount(static_cast<unsigned>(mask)) + 0.25 * corners));
  }
}

double CrackMesh::bytes() const {
  const auto size = [](const auto& v) { return static_cast<double>(v.size() * sizeof(v[0])); };
  return size(edge_length2_) + size(link_row_) + size(link_) + size(link_count_) + size(broken_) +
         size(mask_) + size(cracked_of_tet_) + size(cracked_) + size(faces_) + size(centres_) +
         size(copies_) + size(nodes_) + size(triangles_) + size(skin_) + size(is_near_) +
         size(near_);
}

}  // namespace rend
