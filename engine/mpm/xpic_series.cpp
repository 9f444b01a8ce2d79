// The residual series of XPIC on the grid.
#include "engine/mpm/xpic_series.h"

#include "engine/core/parallel.h"

namespace rend {

void add_xpic_series(int order, const GridTransfer& transfer, const Particles& particles, Real dx,
                     BlockGrid& grid) {
  const Index blocks = static_cast<Index>(grid.grid_blocks().size());
  const std::size_t count = grid.grid_blocks().size() * BlockGrid::kNodes;
  std::vector<Vec3> d(count), momentum(count);
  parallel_for(blocks, 8, [&](Index b) {
    NodeVelocity* node = grid.velocities(b);
    for (int n = 0; n < BlockGrid::kNodes; ++n) {
      d[static_cast<std::size_t>(b) * BlockGrid::kNodes + static_cast<std::size_t>(n)] =
          node[n].v - node[n].change;
      node[n].change.setZero();
    }
  });
  for (int k = 2; k <= order; ++k) {
    std::fill(momentum.begin(), momentum.end(), Vec3::Zero());
    for (int c = 0; c < 8; ++c) {
      const std::vector<Index>& color = grid.color(c);
      parallel_for(static_cast<Index>(color.size()), 1, [&](Index n) {
        const Index block = color[static_cast<std::size_t>(n)];
        transfer.project(grid.particle_blocks()[static_cast<std::size_t>(block)], grid, particles,
                         dx, d.data(), momentum.data());
      });
    }
    parallel_for(blocks, 8, [&](Index b) {
      const GridNode* node = grid.nodes(b);
      NodeVelocity* out = grid.velocities(b);
      for (int n = 0; n < BlockGrid::kNodes; ++n) {
        const std::size_t at =
            static_cast<std::size_t>(b) * BlockGrid::kNodes + static_cast<std::size_t>(n);
        if (!(node[n].mass > 0)) continue;
        d[at] = out[n].held ? Vec3(Vec3::Zero()) : Vec3(d[at] - momentum[at] / node[n].mass);
        out[n].change += d[at];
      }
    });
  }
}

}  // namespace rend
