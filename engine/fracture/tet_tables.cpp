// Bucket sorts instead of hash maps: linear, deterministic and friendly to the cache.
#include "engine/fracture/tet_tables.h"

#include "engine/core/error.h"
#include "engine/fracture/tet_templates.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

namespace rend {

namespace {

// Turns counts stored at [i + 1] into row starts.
void prefix_sum(std::vector<Index>& row) { std::partial_sum(row.begin(), row.end(), row.begin()); }

std::uint64_t pair_key(Index a, Index b) {
  return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
}

int local_edge(const std::array<Index, 6>& edges, Index e) {
  return static_cast<int>(std::find(edges.begin(), edges.end(), e) - edges.begin());
}

}  // namespace

TetTables::TetTables(const Model& model) : X(model.X), body(model.body) {
  body.resize(X.size(), 0);
  {
    const std::vector<Tet> tet = sort_tets(model);
    TetEdges edges = build_edges(tet);
    split_fans(edges, build_faces(model, tet));
    list_tets(tet, edges);
  }
  mark_skin();
  build_skin(model);
  measure(model);
}

Edge TetTables::edge(Index e) const {
  const auto row = std::upper_bound(edge_row.begin(), edge_row.end(), e) - 1;
  return {static_cast<Index>(row - edge_row.begin()), edge_to[e]};
}

void TetTables::ring(Index e, Index lower, std::vector<TetEdge>& out) const {
  out.clear();
  const Index place = e - edge_row[lower];
  for (Index t = first_row[lower]; t < first_row[lower + 1]; ++t)
    for (int k = 0; k < 3; ++k)
      if (tet_place[t][k] == place) out.push_back({t, k});
  for (Index i = second_row[lower]; i < second_row[lower + 1]; ++i)
    for (int k = 3; k < 5; ++k)
      if (tet_place[by_second[i]][k] == place) out.push_back({by_second[i], k});
  for (Index i = third_row[lower]; i < third_row[lower + 1]; ++i)
    if (tet_place[by_third[i]][5] == place) out.push_back({by_third[i], 5});
}

TetTables::TetFace TetTables::across(Index t, int f) const {
  // Two edges from the lowest vertex of a face are enough to name it.
  const bool has_lowest = f < 3;
  const auto& from = tet_place[t];
  const Index lowest = has_lowest ? tet_lowest[t] & ~inside_out : corners(t)[1];
  const int u = has_lowest ? face_edges[f][0] : 3, v = has_lowest ? face_edges[f][1] : 4;
  for (Index i = second_row[lowest]; i < second_row[lowest + 1]; ++i) {
    const Index other = by_second[i];
    if (other != t && tet_place[other][3] == from[u] && tet_place[other][4] == from[v])
      return {other, 3};
  }
  for (Index other = first_row[lowest]; other < first_row[lowest + 1]; ++other)
    for (int face = 0; face < 3; ++face)
      if (other != t && tet_place[other][face_edges[face][0]] == from[u] &&
          tet_place[other][face_edges[face][1]] == from[v])
        return {other, face};
  return {-1, -1};
}

Index TetTables::skin_face(Index t, int f) const {
  if (!tet_on_skin[t]) return -1;
  auto at = std::lower_bound(skin_by_tet.begin(), skin_by_tet.end(), t,
                             [&](Index i, Index tet) { return skin[i].tet < tet; });
  for (; at != skin_by_tet.end() && skin[*at].tet == t; ++at)
    if (skin[*at].face == f) return *at;
  return -1;
}

std::vector<Tet> TetTables::sort_tets(const Model& model) {
  std::vector<Tet> tet = model.tets;
  const Index count = particle_count();
  for (std::size_t t = 0; t < tet.size(); ++t) {
    std::sort(tet[t].begin(), tet[t].end());
    const bool distinct = tet[t][0] < tet[t][1] && tet[t][1] < tet[t][2] && tet[t][2] < tet[t][3];
    if (!distinct || tet[t][0] < 0 || tet[t][3] >= count)
      throw Error("model/tets/" + std::to_string(t),
                  "corners must be four different particles 0.." + std::to_string(count - 1));
  }
  // Tets by their lowest vertex, then the next: neighbours in space become neighbours in memory.
  std::sort(tet.begin(), tet.end());
  tet_lowest.resize(tet.size());
  for (std::size_t t = 0; t < tet.size(); ++t) {
    const Vec3& a = X[tet[t][0]];
    const Real volume = (X[tet[t][1]] - a).cross(X[tet[t][2]] - a).dot(X[tet[t][3]] - a);
    tet_lowest[t] = volume < 0 ? tet[t][0] | inside_out : tet[t][0];
  }
  return tet;
}

TetTables::TetEdges TetTables::build_edges(const std::vector<Tet>& tet) {
  const Index n = particle_count();
  std::vector<Index> bucket(n + 1, 0);
  for (const Tet& v : tet) bucket[v[0] + 1] += 3, bucket[v[1] + 1] += 2, bucket[v[2] + 1] += 1;
  prefix_sum(bucket);
  std::vector<Index> ends(6 * tet.size());
  std::vector<Index> cursor(bucket.begin(), bucket.end() - 1);
  for (const Tet& v : tet)
    for (const auto& e : edge_ends) ends[cursor[v[e[0]]]++] = v[e[1]];
  edge_row.assign(n + 1, 0);
  edge_to.reserve(8 * static_cast<std::size_t>(n));
  for (Index p = 0; p < n; ++p) {
    const auto begin = ends.begin() + bucket[p], end = ends.begin() + bucket[p + 1];
    std::sort(begin, end);
    std::unique_copy(begin, end, std::back_inserter(edge_to));
    edge_row[p + 1] = edge_count();
  }
  TetEdges edges(tet.size());
  for (std::size_t t = 0; t < tet.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const Index a = tet[t][edge_ends[e][0]], b = tet[t][edge_ends[e][1]];
      const auto row = edge_to.begin() + edge_row[a];
      const auto found = std::lower_bound(row, edge_to.begin() + edge_row[a + 1], b);
      edges[t][e] = static_cast<Index>(found - edge_to.begin());
    }
  return edges;
}

std::vector<std::array<Index, 4>> TetTables::build_faces(const Model& model,
                                                         const std::vector<Tet>& tet) {
  const Index n = particle_count();
  std::vector<Index> bucket(n + 1, 0);
  for (const Tet& v : tet) bucket[v[0] + 1] += 3, bucket[v[1] + 1] += 1;
  prefix_sum(bucket);
  std::vector<Index> cursor(bucket.begin(), bucket.end() - 1);
  std::vector<std::pair<std::uint64_t, Index>> faces(4 * tet.size());
  for (Index t = 0; t < tet_count(); ++t)
    for (int f = 0; f < 4; ++f) {
      const auto& c = face_corners[f];
      faces[cursor[tet[t][c[0]]]++] = {pair_key(tet[t][c[1]], tet[t][c[2]]), 4 * t + f};
    }
  std::vector<std::array<Index, 4>> neighbour(tet.size(), {-1, -1, -1, -1});
  std::vector<std::pair<std::array<Index, 3>, Index>> boundary;
  for (Index p = 0; p < n; ++p) {
    const auto begin = faces.begin() + bucket[p], end = faces.begin() + bucket[p + 1];
    std::sort(begin, end);
    for (auto f = begin; f != end;) {
      auto next = f + 1;
      while (next != end && next->first == f->first) ++next;
      const Index t = f->second / 4;
      if (next - f > 2)
        throw Error("model/tets/" + std::to_string(t), "more than two tets share a face");
      if (next - f == 2) {
        neighbour[t][f->second % 4] = (f + 1)->second / 4;
        neighbour[(f + 1)->second / 4][(f + 1)->second % 4] = t;
      } else {
        const auto& c = face_corners[f->second % 4];
        boundary.push_back({{tet[t][c[0]], tet[t][c[1]], tet[t][c[2]]}, f->second});
      }
      f = next;
    }
  }
  std::sort(boundary.begin(), boundary.end());
  if (!model.skin.empty() && model.skin.size() != boundary.size())
    throw Error("model/skin", "has " + std::to_string(model.skin.size()) +
                                  " triangles but the tets have " +
                                  std::to_string(boundary.size()) + " boundary faces");
  skin.resize(boundary.size());
  skin_uncut.resize(boundary.size());
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    std::size_t found = i;
    if (!model.skin.empty()) {
      std::array<Index, 3> key = model.skin[i];
      std::sort(key.begin(), key.end());
      const auto at = std::lower_bound(boundary.begin(), boundary.end(), std::pair(key, Index(0)));
      if (at == boundary.end() || at->first != key)
        throw Error("model/skin/" + std::to_string(i), "is not a boundary face of the tets");
      found = static_cast<std::size_t>(at - boundary.begin());
    }
    const Index t = boundary[found].second / 4;
    const int f = boundary[found].second % 4;
    // (a, b, c) of faces 0 and 2 points into a positive tet, of faces 1 and 3 out of it.
    const bool flip = (f == 0 || f == 2) != negative(t);
    skin[i] = {t, f, flip, {-1, -1, -1}};
    if (model.skin.empty()) {
      const auto& v = boundary[found].first;
      skin_uncut[i] = flip ? Triangle{v[0], v[2], v[1]} : Triangle{v[0], v[1], v[2]};
    } else {
      skin_uncut[i] = model.skin[i];
    }
  }
  return neighbour;
}

void TetTables::split_fans(TetEdges& edges, const std::vector<std::array<Index, 4>>& neighbour) {
  std::vector<std::uint8_t> seen(edges.size(), 0);
  std::vector<TetEdge> fan;
  // Tets around an edge that are reached from one of them across faces.
  const auto walk = [&](Index start, int first) {
    const Index e = edges[start][first];
    fan.assign(1, {start, first});
    for (int direction = 0; direction < 2; ++direction) {
      Index previous = start, t = neighbour[start][edge_faces[first][direction]];
      while (t >= 0) {
        if (t == start) return;
        const int local = local_edge(edges[t], e);
        fan.push_back({t, local});
        const int* faces = edge_faces[local];
        const Index next = neighbour[t][faces[neighbour[t][faces[0]] == previous ? 1 : 0]];
        previous = t;
        t = next;
      }
    }
  };
  struct Fan {
    Index edge;
    std::vector<TetEdge> tets;
  };
  std::vector<Fan> extra;
  std::vector<bool> known(edge_to.size(), false);
  for (Index t = 0; t < tet_count(); ++t)
    for (int k = 0; k < 6; ++k) {
      if (seen[t] >> k & 1) continue;
      walk(t, k);
      for (const TetEdge& at : fan) seen[at.tet] |= static_cast<std::uint8_t>(1 << at.edge);
      const Index e = edges[t][k];
      if (known[e]) extra.push_back({e, fan});
      known[e] = true;
    }
  if (extra.empty()) return;
  std::stable_sort(extra.begin(), extra.end(),
                   [](const Fan& a, const Fan& b) { return a.edge < b.edge; });
  // Every extra fan is inserted right behind the record it was split from.
  std::vector<Index> shift(edge_to.size() + 1, 0);
  for (const Fan& one : extra) ++shift[one.edge + 1];
  prefix_sum(shift);
  std::vector<Index> to(edge_to.size() + extra.size());
  for (Index e = 0; e < edge_count(); ++e)
    for (Index k = e + shift[e]; k <= e + shift[e + 1]; ++k) to[k] = edge_to[e];
  for (auto& six : edges)
    for (Index& e : six) e += shift[e];
  for (std::size_t i = 0; i < extra.size(); ++i) {
    const Index id = extra[i].edge + static_cast<Index>(i) + 1;
    for (const TetEdge& at : extra[i].tets) edges[at.tet][at.edge] = id;
  }
  for (Index& row : edge_row) row += shift[row];
  edge_to = std::move(to);
}

void TetTables::list_tets(const std::vector<Tet>& tet, const TetEdges& edges) {
  const auto rows_of = [&](int k) {
    std::vector<Index> row(X.size() + 1, 0);
    for (const Tet& v : tet) ++row[v[k] + 1];
    prefix_sum(row);
    return row;
  };
  const auto list_of = [&](int k, const std::vector<Index>& row) {
    std::vector<Index> list(tet.size()), cursor(row.begin(), row.end() - 1);
    for (Index t = 0; t < tet_count(); ++t) list[cursor[tet[t][k]]++] = t;
    return list;
  };
  first_row = rows_of(0), second_row = rows_of(1), third_row = rows_of(2);
  by_second = list_of(1, second_row), by_third = list_of(2, third_row);
  tet_place.resize(tet.size());
  for (std::size_t t = 0; t < tet.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const Index place = edges[t][e] - edge_row[tet[t][edge_ends[e][0]]];
      if (place > std::numeric_limits<std::uint16_t>::max())
        throw Error("model/tets/" + std::to_string(t), "more than 65535 edges at one particle");
      tet_place[t][e] = static_cast<std::uint16_t>(place);
    }
}

void TetTables::mark_skin() {
  tet_on_skin.assign(tet_lowest.size(), false);
  edge_on_skin.assign(edge_to.size(), false);
  skin_by_tet.resize(skin.size());
  std::iota(skin_by_tet.begin(), skin_by_tet.end(), 0);
  std::sort(skin_by_tet.begin(), skin_by_tet.end(), [&](Index i, Index j) {
    return std::pair(skin[i].tet, skin[i].face) < std::pair(skin[j].tet, skin[j].face);
  });
  for (const SkinFace& face : skin) {
    tet_on_skin[face.tet] = true;
    const auto e = edges(face.tet);
    for (int k : face_edges[face.face]) edge_on_skin[e[k]] = true;
  }
}

void TetTables::build_skin(const Model&) {
  const Index faces = skin_count();
  std::vector<Index> parent(3 * static_cast<std::size_t>(faces));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index c) {
    while (parent[c] != c) c = parent[c] = parent[parent[c]];
    return c;
  };
  constexpr int ends[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  std::vector<std::pair<Index, Index>> sides;
  for (Index i = 0; i < faces; ++i)
    for (int k = 0; k < 3; ++k)
      sides.emplace_back(edges(skin[i].tet)[face_edges[skin[i].face][k]], 3 * i + k);
  std::sort(sides.begin(), sides.end());
  for (std::size_t s = 0; s + 1 < sides.size(); s += 2)
    for (int end = 0; end < 2; ++end) {
      const auto corner = [&](Index side) { return side / 3 * 3 + ends[side % 3][end]; };
      const Index a = root(corner(sides[s].second)), b = root(corner(sides[s + 1].second));
      parent[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::pair<Index, Index>> roots;  // (particle, corner)
  const auto particle = [&](Index c) {
    return corners(skin[c / 3].tet)[face_corners[skin[c / 3].face][c % 3]];
  };
  for (Index c = 0; c < 3 * faces; ++c)
    if (root(c) == c) roots.emplace_back(particle(c), c);
  std::sort(roots.begin(), roots.end());
  std::vector<Index> vertex(parent.size(), -1);
  for (const auto& [p, c] : roots) {
    vertex[c] = static_cast<Index>(skin_particle.size());
    skin_particle.push_back(p);
  }
  for (Index i = 0; i < faces; ++i) {
    Triangle uncut{};
    for (int k = 0; k < 3; ++k) {
      skin[i].vertex[k] = vertex[root(3 * i + k)];
      const auto at = std::find(skin_uncut[i].begin(), skin_uncut[i].end(), particle(3 * i + k));
      uncut[at - skin_uncut[i].begin()] = skin[i].vertex[k];
    }
    skin_uncut[i] = uncut;
  }
}

void TetTables::measure(const Model& model) {
  const std::size_t bodies = std::max<std::size_t>(
      model.spacing.size(), body.empty() ? 0 : 1u + *std::max_element(body.begin(), body.end()));
  std::vector<Index> count(bodies, 0);
  mean_edge.assign(bodies, 0);
  for (Index p = 0; p < particle_count(); ++p)
    for (Index e = edge_row[p]; e < edge_row[p + 1]; ++e) {
      mean_edge[body[p]] += (X[edge_to[e]] - X[p]).norm();
      ++count[body[p]];
    }
  for (std::size_t b = 0; b < bodies; ++b)
    if (count[b] > 0) mean_edge[b] /= count[b];
}

double TetTables::bytes_per_particle() const {
  const auto bytes = [](const auto& v) { return static_cast<double>(v.size() * sizeof(v[0])); };
  const auto bits = [](const std::vector<bool>& v) { return static_cast<double>(v.size()) / 8; };
  const double total = bytes(X) + bytes(edge_row) + bytes(edge_to) + bytes(tet_lowest) +
                       bytes(tet_place) + bytes(first_row) + bytes(second_row) + bytes(third_row) +
                       bytes(by_second) + bytes(by_third) + bits(tet_on_skin) + bits(edge_on_skin) +
                       bytes(skin) + bytes(skin_by_tet) + bytes(skin_uncut) + bytes(skin_particle) +
                       bytes(body);
  return total / std::max<double>(1, static_cast<double>(X.size()));
}

}  // namespace rend
