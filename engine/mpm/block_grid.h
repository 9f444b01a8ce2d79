// The sparse background grid: blocks of 4^3 nodes where particles are, rebuilt as they move.
#pragma once

#include "engine/core/types.h"

#include <array>
#include <vector>

namespace rend {

/// What particles give to a node.
struct GridNode {
  Real mass = 0;                 ///< [kg]
  Vec3 momentum = Vec3::Zero();  ///< [kg m/s]
  Vec3 force = Vec3::Zero();     ///< -dPhi/dx_i [N]
};

/// What a node gives back.
struct NodeVelocity {
  Vec3 v = Vec3::Zero();       ///< after forces and contact [m/s]
  Vec3 change = Vec3::Zero();  ///< v - v^n; with XPIC what its series adds to v [m/s]
  bool held = false;           ///< met a collider
};

/// Nodes lie at integer multiples of dx from the world origin. A particle belongs to the block of
/// its first node and touches at most that block and its neighbours towards +x, +y, +z. Blocks and
/// the particles of a block are in a canonical order (coordinates, ids), so sums over them do not
/// depend on threads or on history.
class BlockGrid {
 public:
  static constexpr int kEdge = 4;
  static constexpr int kNodes = kEdge * kEdge * kEdge;
  static constexpr Index kLimit = Index(1) << 20;  ///< coordinates stay within +-kLimit cells

  struct ParticleBlock {
    Vec3i coord;                ///< in blocks
    Index begin, end;           ///< range of order()
    std::array<Index, 8> grid;  ///< grid blocks at coord + {0,1}^3, z fastest
  };

  /// Builds blocks for particles with these first nodes; cheap when no particle changed its block.
  void rebuild(const std::vector<Vec3i>& first_node);

  /// Zeroes all nodes.
  void clear();

  const std::vector<Index>& order() const { return order_; }
  const std::vector<ParticleBlock>& particle_blocks() const { return particle_blocks_; }
  /// Particle blocks of one colour 0..7 share no node, so they may scatter at the same time.
  const std::vector<Index>& color(int c) const { return color_[static_cast<std::size_t>(c)]; }
  const std::vector<Vec3i>& grid_blocks() const { return grid_blocks_; }

  GridNode* nodes(Index block) { return &nodes_[static_cast<std::size_t>(block) * kNodes]; }
  const GridNode* nodes(Index block) const {
    return &nodes_[static_cast<std::size_t>(block) * kNodes];
  }
  NodeVelocity* velocities(Index block) {
    return &velocities_[static_cast<std::size_t>(block) * kNodes];
  }

  /// Index of the node at `local` (0..7 per axis) of a particle block, into all nodes.
  static Index node_index(const ParticleBlock& block, int i, int j, int k) {
    const int which = (i >> 2) * 4 + (j >> 2) * 2 + (k >> 2);
    return block.grid[static_cast<std::size_t>(which)] * kNodes + (i & 3) * 16 + (j & 3) * 4 +
           (k & 3);
  }
  GridNode& node(Index index) { return nodes_[static_cast<std::size_t>(index)]; }
  const NodeVelocity& velocity(Index index) const {
    return velocities_[static_cast<std::size_t>(index)];
  }

  /// World position of node n (0..63) of a grid block.
  Vec3 position(Index block, int n, Real dx) const {
    const Vec3i node =
        kEdge * grid_blocks_[static_cast<std::size_t>(block)] + Vec3i(n >> 4, (n >> 2) & 3, n & 3);
    return dx * node.cast<Real>();
  }

  double bytes() const;

 private:
  std::vector<std::uint64_t> key_;  ///< block of every particle
  std::vector<Index> order_;        ///< particle ids by block, then id
  std::vector<ParticleBlock> particle_blocks_;
  std::array<std::vector<Index>, 8> color_;
  std::vector<Vec3i> grid_blocks_;
  std::vector<GridNode> nodes_;
  std::vector<NodeVelocity> velocities_;
};

}  // namespace rend
