// Nodal forces: the derivative of the energy, without resultant and without torque.
#include "engine/core/random.h"
#include "engine/material/material_point.h"
#include "engine/mpm/grid_transfer.h"
#include "engine/mpm/kernel.h"
#include "tests/mpm/lattice_model.h"

#include <doctest/doctest.h>

#include <map>

using namespace rend;

namespace {

struct Loaded {
  SceneDesc scene;
  Particles particles;
  LawConstants<Real> k;
  BlockGrid grid;
  GridTransfer transfer;
};

// A few particles with random elastic deformation gradients, scattered to the grid.
Loaded scatter(Kernel kernel, ForceForm form) {
  Loaded s;
  s.scene = plain_scene();
  s.scene.grid.dx = 0.7;
  s.scene.solver.kernel = kernel;
  s.scene.solver.force_form = form;
  s.k = law_constants(s.scene.materials[0]);
  s.transfer = make_grid_transfer(s.scene.solver);
  Random random(2, 7);
  const StressUpdate respond = stress_update(s.scene.materials[0]);
  std::vector<Vec3i> first;
  for (int p = 0; p < 12; ++p) {
    const auto next = [&] { return random.next(-1, 1); };
    s.particles.x.push_back(Vec3(next(), next(), next()));
    s.particles.v.push_back(Vec3(next(), next(), next()));
    s.particles.C.push_back(Mat3::Zero());
    Mat3 F = Mat3::Identity();
    for (int i = 0; i < 9; ++i) F(i) += 0.2 * next();
    Real tau_c = 1;
    s.particles.tau.push_back(respond(s.k, F, tau_c, 1).tau);
    s.particles.F.push_back(F);
    s.particles.volume.push_back(0.1 + 0.05 * next());
    s.particles.mass.push_back(1 + 0.5 * next());
    first.push_back(s.transfer.first_node(s.particles.x.back(), s.scene.grid.dx));
  }
  s.grid.rebuild(first);
  s.grid.clear();
  for (const auto& block : s.grid.particle_blocks())
    s.transfer.scatter(block, s.particles, s.scene.grid.dx, s.grid);
  return s;
}

// Energy after the nodes have moved by u, F <- (1 + sum u_i grad w_i^T) F.
template <class K>
Real moved_energy(const Loaded& s, const std::map<std::array<int, 3>, Vec3>& u, ForceForm form) {
  Real energy = 0;
  const Real dx = s.scene.grid.dx;
  for (std::size_t p = 0; p < s.particles.x.size(); ++p) {
    const Stencil<K> st(s.particles.x[p], dx);
    Mat3 grad = Mat3::Zero();
    for (int i = 0; i < K::kNodes; ++i)
      for (int j = 0; j < K::kNodes; ++j)
        for (int k = 0; k < K::kNodes; ++k) {
          const auto it = u.find({st.base[0] + i, st.base[1] + j, st.base[2] + k});
          if (it == u.end()) continue;
          const Vec3 g = form == ForceForm::gradient
                             ? Vec3(st.dw[0][i] * st.w[1][j] * st.w[2][k],
                                    st.w[0][i] * st.dw[1][j] * st.w[2][k],
                                    st.w[0][i] * st.w[1][j] * st.dw[2][k])
                             : Vec3(st.w[0][i] * st.w[1][j] * st.w[2][k] / (K::kInertia * dx * dx) *
                                    Vec3(st.r[0][i], st.r[1][j], st.r[2][k]));
          grad += it->second * g.transpose();
        }
    energy += s.particles.volume[p] *
              elastic_energy_density(s.k, (Mat3::Identity() + grad) * s.particles.F[p], false);
  }
  return energy;
}

}  // namespace

TEST_CASE("nodal force is -dPhi/dx_i, sums to zero and has no torque") {
  for (Kernel kernel : {Kernel::quadratic, Kernel::cubic})
    for (ForceForm form : {ForceForm::mls, ForceForm::gradient}) {
      const Loaded s = scatter(kernel, form);
      Vec3 sum = Vec3::Zero(), torque = Vec3::Zero(), momentum = Vec3::Zero();
      Real size = 0, mass = 0;
      int checked = 0;
      for (Index b = 0; b < static_cast<Index>(s.grid.grid_blocks().size()); ++b)
        for (int n = 0; n < BlockGrid::kNodes; ++n) {
          const GridNode& node = s.grid.nodes(b)[n];
          const Vec3 x = s.grid.position(b, n, s.scene.grid.dx);
          sum += node.force;
          torque += x.cross(node.force);
          size += node.force.norm();
          mass += node.mass;
          momentum += node.momentum;
          if (node.mass == 0 || ++checked % 5 != 0) continue;
          const Vec3i id = (x / s.scene.grid.dx).array().round().cast<int>();
          for (int a = 0; a < 3; ++a) {
            const Real h = 1e-5;
            std::map<std::array<int, 3>, Vec3> plus, minus;
            plus[{id[0], id[1], id[2]}] = h * Vec3::Unit(a);
            minus[{id[0], id[1], id[2]}] = -h * Vec3::Unit(a);
            const auto energy = [&](const auto& u) {
              return kernel == Kernel::quadratic ? moved_energy<QuadraticKernel>(s, u, form)
                                                 : moved_energy<CubicKernel>(s, u, form);
            };
            CHECK(std::abs(node.force[a] + (energy(plus) - energy(minus)) / (2 * h)) < 1e-6);
          }
        }
      CHECK(checked > 30);
      CHECK(size > 1);
      CHECK(sum.norm() < 1e-13 * size);
      CHECK(torque.norm() < 1e-12 * size);
      Real particle_mass = 0;
      Vec3 particle_momentum = Vec3::Zero();
      for (std::size_t p = 0; p < s.particles.x.size(); ++p) {
        particle_mass += s.particles.mass[p];
        particle_momentum += s.particles.mass[p] * s.particles.v[p];
      }
      CHECK(mass == doctest::Approx(particle_mass).epsilon(1e-14));
      CHECK((momentum - particle_momentum).norm() < 1e-13);
    }
}
