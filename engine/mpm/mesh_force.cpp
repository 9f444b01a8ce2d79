// Elements: trial strain from positions, return mapping, forces on vertices.
#include "engine/mpm/mesh_force.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/small_matrix.h"
#include "engine/mpm/time_step.h"

#include <fmt/format.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rend {

namespace {

constexpr Index kGrain = 256;

// Rubble thinner than this share of its rest volume and shape is crushed: contact is left to the
// grid, else a damaged element would freeze the time step.
constexpr Real kCrushed = 0.25;

Mat3 edges(const Tet& t, const std::vector<Vec3>& x) {
  const Vec3& o = x[static_cast<std::size_t>(t[0])];
  Mat3 D;
  for (int k = 0; k < 3; ++k) D.col(k) = x[static_cast<std::size_t>(t[k + 1])] - o;
  return D;
}

// Largest eigenvalue of sum_q g_q g_q^T for shape gradients g_q, from D^-1 whose rows are g_1..g_3.
Real gradient_size(const Mat3& D_inverse) {
  const Vec3 g0 = D_inverse.colwise().sum();
  return symmetric_eigen(D_inverse.transpose() * D_inverse + g0 * g0.transpose()).value.maxCoeff();
}

}  // namespace

MeshForce::Sums& MeshForce::Sums::operator+=(const Sums& other) {
  dissipation += other.dissipation;
  rate = std::max(rate, other.rate);
  clamped += other.clamped;
  return *this;
}

MeshForce::MeshForce(const SceneDesc& scene, const Model& model,
                     const std::vector<SolverMaterial>& materials) {
  const auto is_mesh = [&](std::size_t particle) {
    const std::size_t body = model.body[particle];
    return body < scene.bodies.size() && scene.bodies[body].force == ForceKind::mesh;
  };
  const std::size_t count = model.X.size();
  if (std::none_of(scene.bodies.begin(), scene.bodies.end(),
                   [](const BodyDesc& b) { return b.force == ForceKind::mesh; }))
    return;
  on_mesh_.resize(count);
  for (std::size_t p = 0; p < count; ++p) on_mesh_[p] = is_mesh(p);
  std::vector<Real> lumped(count, 0);
  for (const Tet& t : model.tets) {
    const auto first = static_cast<std::size_t>(t[0]);
    if (!on_mesh_[first]) continue;
    const Mat3 D = edges(t, model.X);
    const Real volume = D.determinant() / 6;
    if (!(volume > 1e-9 * std::pow(D.norm(), 3)))
      throw Error(fmt::format("/bodies/{}", model.body[first]),
                  "has a flat tet; choose another particles_per_cell or seed");
    Real strength = 1;
    if (!model.strength.empty()) {
      strength = 0;
      for (Index v : t) strength += 0.25 * model.strength[static_cast<std::size_t>(v)];
    }
    elements_.push_back({t, D.inverse(), volume, 1, strength, model.material[first]});
    for (Index v : t) lumped[static_cast<std::size_t>(v)] += volume / 4;
  }
  for (Element& e : elements_)
    for (Index v : e.corner)
      e.lightness = std::min(e.lightness, model.volume[static_cast<std::size_t>(v)] /
                                              lumped[static_cast<std::size_t>(v)]);

  first_use_.assign(count + 1, 0);
  for (const Element& e : elements_)
    for (Index v : e.corner) ++first_use_[static_cast<std::size_t>(v) + 1];
  std::partial_sum(first_use_.begin(), first_use_.end(), first_use_.begin());
  uses_.resize(4 * elements_.size());
  std::vector<Index> next = first_use_;
  for (std::size_t e = 0; e < elements_.size(); ++e)
    for (std::size_t k = 0; k < 4; ++k)
      uses_[static_cast<std::size_t>(next[static_cast<std::size_t>(elements_[e].corner[k])]++)] =
          static_cast<Index>(4 * e + k);

  pull_.resize(elements_.size());
  state_.plastic_inverse.assign(elements_.size(), Mat3::Identity());
  state_.tau.assign(elements_.size(), Mat3::Zero());
  state_.yielded.assign(elements_.size(), 0);
  for (std::size_t e = 0; e < elements_.size(); ++e) state_.tau_c.push_back(tau_c0(materials, e));
}

MeshForce::Sums MeshForce::evaluate(const std::vector<SolverMaterial>& materials,
                                    const std::vector<Vec3>& x, std::vector<Vec3>& force) {
  const Sums sums = ordered_sum(static_cast<Index>(elements_.size()), kGrain, Sums(), [&](Index e) {
    return evaluate_element(materials, x, static_cast<std::size_t>(e));
  });
  parallel_for(static_cast<Index>(x.size()), kGrain, [&](Index p) {
    const auto i = static_cast<std::size_t>(p);
    Vec3 sum = Vec3::Zero();
    for (Index u = first_use_[i]; u < first_use_[i + 1]; ++u) {
      const Index use = uses_[static_cast<std::size_t>(u)];
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

MeshForce::Sums MeshForce::evaluate_element(const std::vector<SolverMaterial>& materials,
                                            const std::vector<Vec3>& x, std::size_t e) {
  const Element& element = elements_[e];
  const SolverMaterial& material = materials[element.material];
  Mat3& plastic_inverse = state_.plastic_inverse[e];
  const Mat3 D = edges(element.corner, x);
  const Mat3 F = D * element.rest_inverse;
  Mat3 elastic = F * plastic_inverse;
  Sums sums;
  if (is_damaged(materials, e)) {
    const Real thickness = 1 / std::sqrt(gradient_size(D.inverse()));
    const Real at_rest = 1 / std::sqrt(gradient_size(element.rest_inverse));
    if (!(elastic.determinant() > 0 && F.determinant() > 0 && thickness > kCrushed * at_rest)) {
      state_.tau[e].setZero();
      pull_[e].setZero();
      return sums;
    }
  }
  const PointUpdate update =
      material.respond(material.constants, elastic, state_.tau_c[e], tau_c0(materials, e));
  state_.tau[e] = update.tau;
  state_.yielded[e] |= update.yielded;
  // The clamp of a flat element is not plastic flow, and F has no inverse there.
  if (update.yielded && !update.clamped) plastic_inverse = F.inverse() * elastic;
  const Mat3 piola = update.tau * elastic.inverse().transpose() * plastic_inverse.transpose();
  pull_[e] = -element.volume * piola * element.rest_inverse.transpose();

  const Real stiffness =
      wave_stiffness(material.lame.mu, material.lame.lambda, update.least_stress);
  const Mat3 shape =
      update.clamped
          ? Mat3((elastic * plastic_inverse.inverse() * element.rest_inverse.inverse()).inverse())
          : Mat3(D.inverse());
  sums.rate =
      std::sqrt(gradient_size(shape) * stiffness / (material.desc.density * element.lightness));
  sums.dissipation = element.volume * update.dissipation;
  sums.clamped = update.clamped;
  return sums;
}

bool MeshForce::is_damaged(const std::vector<SolverMaterial>& materials, std::size_t e) const {
  return materials[elements_[e].material].desc.damage.type != DamageType::off &&
         !(state_.tau_c[e] > 0);
}

Real MeshForce::elastic_energy(const std::vector<SolverMaterial>& materials,
                               const std::vector<Vec3>& x) const {
  return ordered_sum(static_cast<Index>(elements_.size()), kGrain, 0.0, [&](Index n) {
    const auto e = static_cast<std::size_t>(n);
    const Element& element = elements_[e];
    const bool damaged = is_damaged(materials, e);
    // Crushed rubble carries no stress and so no energy.
    if (damaged && state_.tau[e].isZero(0)) return 0.0;
    const Mat3 elastic =
        edges(element.corner, x) * element.rest_inverse * state_.plastic_inverse[e];
    return element.volume *
           elastic_energy_density(materials[element.material].constants, elastic, damaged);
  });
}

MeshForce::VertexState MeshForce::at_vertex(const std::vector<SolverMaterial>& materials,
                                            Index particle) const {
  VertexState out;
  const auto i = static_cast<std::size_t>(particle);
  Real stress = 0;
  for (Index u = first_use_[i]; u < first_use_[i + 1]; ++u) {
    const auto e = static_cast<std::size_t>(uses_[static_cast<std::size_t>(u)] / 4);
    const bool damaged = is_damaged(materials, e);
    const Real full = tau_c0(materials, e);
    const Real lost = damaged ? 1 : full > 0 ? 1 - state_.tau_c[e] / full : 0;
    out.damage = std::max(out.damage, static_cast<float>(std::clamp(lost, 0.0, 1.0)));
    const Real largest = symmetric_eigen(state_.tau[e]).value.maxCoeff();
    stress = u == first_use_[i] ? largest : std::max(stress, largest);
    out.yielded = out.yielded || state_.yielded[e] != 0;
    out.damaged = out.damaged || damaged;
  }
  out.stress = static_cast<float>(stress);
  return out;
}

void MeshForce::rescale_thresholds(const std::vector<SolverMaterial>& materials,
                                   std::size_t material, Real before) {
  const Real now = materials[material].tau_c0;
  for (std::size_t e = 0; e < elements_.size(); ++e)
    if (elements_[e].material == material && (state_.tau_c[e] > 0 || before == 0))
      state_.tau_c[e] = before > 0 ? state_.tau_c[e] * (now / before) : tau_c0(materials, e);
}

double MeshForce::bytes() const {
  const double each = sizeof(Element) + 3 * sizeof(Mat3) + sizeof(Real) + 1 + 4 * sizeof(Index);
  return each * static_cast<double>(elements_.size());
}

}  // namespace rend
