// Union-find from scratch: a deletion cannot be undone in a union-find, and one sweep costs less
// than a search.
#include "engine/fracture/pieces.h"

#include <algorithm>
#include <numeric>

namespace rend {

namespace {

Index find_root(std::vector<Index>& parent, Index p) {
  while (parent[p] != p) p = parent[p] = parent[parent[p]];
  return p;
}

template <class Broken>
void join_all(const TetTables& tables, std::vector<Index>& parent, Broken&& broken) {
  std::iota(parent.begin(), parent.end(), 0);
  for (Index p = 0; p < tables.particle_count(); ++p) {
    Index root = find_root(parent, p);
    for (Index e = tables.edge_row[p]; e < tables.edge_row[p + 1]; ++e) {
      if (broken(e)) continue;
      const Index other = find_root(parent, tables.edge_to[e]);
      if (root == other) continue;
      // The lower number wins, so a root is the lowest particle of its component.
      parent[std::max(root, other)] = std::min(root, other);
      root = std::min(root, other);
    }
  }
  for (Index p = 0; p < tables.particle_count(); ++p) parent[p] = parent[parent[p]];
}

}  // namespace

Pieces::Pieces(const TetTables& tables) : id_(tables.X.size()), root_(tables.X.size()) {
  join_all(tables, root_, [](Index) { return false; });
  for (Index p = 0; p < tables.particle_count(); ++p)
    id_[p] = root_[p] == p ? next_id_++ : id_[root_[p]];
  count_ = next_id_;
}

std::vector<Index> Pieces::sizes() const {
  std::vector<Index> size(static_cast<std::size_t>(next_id_), 0);
  for (Index id : id_) ++size[id];
  return size;
}

void Pieces::update(const CrackMesh& crack) {
  const TetTables& tables = crack.tables();
  join_all(tables, root_, [&](Index e) { return crack.broken(e); });
  std::vector<Index> size(id_.size(), 0);
  for (Index r : root_) ++size[r];
  std::vector<Index> heir(static_cast<std::size_t>(next_id_),
                          -1);  // old id -> root of its largest part
  for (Index p = 0; p < tables.particle_count(); ++p) {
    if (root_[p] != p) continue;
    Index& best = heir[id_[p]];
    if (best < 0 || size[p] > size[best]) best = p;
  }
  count_ = 0;
  for (Index p = 0; p < tables.particle_count(); ++p) {
    if (root_[p] == p) {
      ++count_;
      if (heir[id_[p]] != p) id_[p] = next_id_++;
    } else {
      id_[p] = id_[root_[p]];
    }
  }
}

}  // namespace rend
