// The particle-grid loops, written once for all kernels, schemes and force forms.
#include "engine/mpm/grid_transfer.h"

#include "engine/core/error.h"
#include "engine/mpm/kernel.h"
#include "engine/mpm/transfer_list.h"

namespace rend {

namespace {

// Calls f(node index, weight, grad w or w D^-1 r, r) for all nodes of a particle.
template <class Kernel, ForceForm form, class F>
void for_each_node(const BlockGrid::ParticleBlock& block, const Vec3& x, Real dx, F&& f) {
  const Stencil<Kernel> s(x, dx);
  const Vec3i local = s.base - BlockGrid::kEdge * block.coord;
  const Real scale = 1 / (Kernel::kInertia * dx * dx);
  for (int i = 0; i < Kernel::kNodes; ++i)
    for (int j = 0; j < Kernel::kNodes; ++j) {
      const Real wij = s.w[0][i] * s.w[1][j];
      for (int k = 0; k < Kernel::kNodes; ++k) {
        const Real w = wij * s.w[2][k];
        const Vec3 r(s.r[0][i], s.r[1][j], s.r[2][k]);
        const Index node = BlockGrid::node_index(block, local[0] + i, local[1] + j, local[2] + k);
        if constexpr (form == ForceForm::mls)
          f(node, w, Vec3(w * scale * r), r);
        else
          f(node, w,
            Vec3(s.dw[0][i] * s.w[1][j] * s.w[2][k], s.w[0][i] * s.dw[1][j] * s.w[2][k],
                 wij * s.dw[2][k]),
            r);
      }
    }
}

template <class Kernel, class Scheme, ForceForm form>
struct Loops {
  static Vec3i first_node(const Vec3& x, Real dx) { return Stencil<Kernel>(x, dx).base; }

  static void scatter(const BlockGrid::ParticleBlock& block, const Particles& particles, Real dx,
                      BlockGrid& grid) {
    for (Index n = block.begin; n < block.end; ++n) {
      const Index p = grid.order()[static_cast<std::size_t>(n)];
      const auto i = static_cast<std::size_t>(p);
      const Real mass = particles.mass[i];
      const Mat3 stress = particles.volume[i] * particles.tau[i];
      const Vec3 force = particles.force.empty() ? Vec3(Vec3::Zero()) : particles.force[i];
      for_each_node<Kernel, form>(block, particles.x[i], dx,
                                  [&](Index at, Real w, const Vec3& g, const Vec3& r) {
                                    GridNode& node = grid.node(at);
                                    node.mass += w * mass;
                                    node.momentum += (w * mass) * Scheme::carried(particles, p, r);
                                    node.force += w * force - stress * g;
                                  });
    }
  }

  static void gather(const BlockGrid::ParticleBlock& block, const BlockGrid& grid, Real dx,
                     const SolverDesc& solver, Particles& particles, GridSample* sample) {
    const Real inertia = Kernel::kInertia * dx * dx;
    for (Index n = block.begin; n < block.end; ++n) {
      const Index p = grid.order()[static_cast<std::size_t>(n)];
      GridSample out;
      Mat3 B = Mat3::Zero();
      typename Scheme::Sums sums;
      for_each_node<Kernel, form>(block, particles.x[static_cast<std::size_t>(p)], dx,
                                  [&](Index at, Real w, const Vec3& g, const Vec3& r) {
                                    const NodeVelocity& node = grid.velocity(at);
                                    const Vec3 wv = w * node.v;
                                    out.pic += wv;
                                    if constexpr (Scheme::kAffine || form == ForceForm::mls)
                                      B += wv * r.transpose();
                                    if constexpr (form == ForceForm::gradient)
                                      out.gradient += node.v * g.transpose();
                                    sums.add(w, node, r);
                                  });
      if constexpr (form == ForceForm::mls) out.gradient = B / inertia;
      Scheme::receive(sums, out.pic, B, inertia, solver, particles, p);
      sample[n - block.begin] = out;
    }
  }

  static void project(const BlockGrid::ParticleBlock& block, const BlockGrid& grid,
                      const Particles& particles, Real dx, const Vec3* velocity, Vec3* momentum) {
    for (Index n = block.begin; n < block.end; ++n) {
      const auto i = static_cast<std::size_t>(grid.order()[static_cast<std::size_t>(n)]);
      Vec3 v = Vec3::Zero();
      const auto each = [&](auto&& f) {
        for_each_node<Kernel, ForceForm::mls>(
            block, particles.x[i], dx,
            [&](Index at, Real w, const Vec3&, const Vec3&) { f(at, w); });
      };
      each([&](Index at, Real w) { v += w * velocity[at]; });
      v *= particles.mass[i];
      each([&](Index at, Real w) { momentum[at] += w * v; });
    }
  }
};

template <class Kernel, class Scheme, ForceForm form>
GridTransfer loops() {
  using L = Loops<Kernel, Scheme, form>;
  return {L::first_node, L::scatter, L::gather, L::project, Kernel::kInertia, {}};
}

template <class Kernel, class Scheme>
GridTransfer loops(ForceForm form) {
  return form == ForceForm::mls ? loops<Kernel, Scheme, ForceForm::mls>()
                                : loops<Kernel, Scheme, ForceForm::gradient>();
}

}  // namespace

GridTransfer make_grid_transfer(const SolverDesc& solver) {
  GridTransfer made;
  const bool listed = with_transfer(solver.transfer, [&](auto scheme) {
    using Scheme = decltype(scheme);
    made = solver.kernel == Kernel::quadratic ? loops<QuadraticKernel, Scheme>(solver.force_form)
                                              : loops<CubicKernel, Scheme>(solver.force_form);
    made.carried = Scheme::carries(solver);
  });
  if (!listed) throw Error("/solver/transfer", "is not in the list of transfer schemes");
  return made;
}

}  // namespace rend
