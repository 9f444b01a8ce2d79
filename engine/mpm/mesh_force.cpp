// Loops over elements and their vertices.
#include "engine/mpm/mesh_force.h"

#include "engine/core/parallel.h"
#include "engine/core/small_matrix.h"

namespace rend {

namespace {

constexpr Index kGrain = 256;

}  // namespace

MeshForce::Sums& MeshForce::Sums::operator+=(const Sums& other) {
  dissipation += other.dissipation;
  rate = std::max(rate, other.rate);
  clamped += other.clamped;
  return *this;
}

MeshForce::MeshForce(const SceneDesc& scene, const Model& model,
                     const std::vector<SolverMaterial>& materials)
    : mesh_(scene, model) {
  const std::size_t count = mesh_.elements.size();
  pull_.resize(count);
  state_.plastic_inverse.assign(count, Mat3::Identity());
  state_.tau.assign(count, Mat3::Zero());
  state_.yielded.assign(count, 0);
  for (std::size_t e = 0; e < count; ++e) state_.tau_c.push_back(tau_c0(materials, e));
}

MeshForce::Sums MeshForce::evaluate(const std::vector<SolverMaterial>& materials,
                                    const std::vector<Vec3>& x, std::vector<Vec3>& force) {
  const Sums sums =
      ordered_sum(static_cast<Index>(mesh_.elements.size()), kGrain, Sums(), [&](Index n) {
        const auto e = static_cast<std::size_t>(n);
        const MeshElement& element = mesh_.elements[e];
        const ElementUpdate update =
            update_element(materials[element.material], element, element_edges(element.corner, x),
                           state_.plastic_inverse[e], state_.tau_c[e]);
        state_.tau[e] = update.tau;
        state_.yielded[e] |= update.yielded;
        pull_[e] = update.pull;
        return Sums{element.volume * update.dissipation, update.rate, update.clamped};
      });
  parallel_for(static_cast<Index>(x.size()), kGrain, [&](Index p) {
    const auto i = static_cast<std::size_t>(p);
    Vec3 sum = Vec3::Zero();
    for (Index u = mesh_.first_use[i]; u < mesh_.first_use[i + 1]; ++u) {
      const Index use = mesh_.uses[static_cast<std::size_t>(u)];
      const Mat3& pull = pull_[static_cast<std::size_t>(use / 4)];
      if (use % 4 == 0)
        sum -= pull.rowwise().sum();
      else
        sum += pull.col(use % 4 - 1);
    }
    force[i] = sum;
  });
  return sums;
}

Real MeshForce::elastic_energy(const std::vector<SolverMaterial>& materials,
                               const std::vector<Vec3>& x) const {
  return ordered_sum(static_cast<Index>(mesh_.elements.size()), kGrain, 0.0, [&](Index n) {
    const auto e = static_cast<std::size_t>(n);
    const MeshElement& element = mesh_.elements[e];
    return element.volume * element_energy_density(materials[element.material], element,
                                                   element_edges(element.corner, x),
                                                   state_.plastic_inverse[e], state_.tau_c[e]);
  });
}

VertexState MeshForce::at_vertex(const std::vector<SolverMaterial>& materials,
                                 Index particle) const {
  VertexState out;
  const auto i = static_cast<std::size_t>(particle);
  for (Index u = mesh_.first_use[i]; u < mesh_.first_use[i + 1]; ++u) {
    const auto e = static_cast<std::size_t>(mesh_.uses[static_cast<std::size_t>(u)] / 4);
    const SolverMaterial& material = materials[mesh_.elements[e].material];
    out.add(state_.tau_c[e], tau_c0(materials, e), element_is_damaged(material, state_.tau_c[e]),
            state_.yielded[e] != 0,
            static_cast<float>(symmetric_eigen(state_.tau[e]).value.maxCoeff()));
  }
  return out;
}

void MeshForce::rescale_thresholds(const std::vector<SolverMaterial>& materials,
                                   std::size_t material, Real before) {
  const Real now = materials[material].tau_c0;
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e)
    if (mesh_.elements[e].material == material && (state_.tau_c[e] > 0 || before == 0))
      state_.tau_c[e] = before > 0 ? state_.tau_c[e] * (now / before) : tau_c0(materials, e);
}

double MeshForce::bytes() const {
  const double each = sizeof(MeshElement) + 3 * sizeof(Mat3) + sizeof(Real) + 1 + 4 * sizeof(Index);
  return each * static_cast<double>(mesh_.elements.size());
}

}  // namespace rend
