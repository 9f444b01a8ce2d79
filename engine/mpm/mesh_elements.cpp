// Elements at rest, and the response of one in double.
#include "engine/mpm/mesh_elements.h"

#include "engine/core/error.h"
#include "engine/core/small_matrix.h"
#include "engine/mpm/time_step.h"

#include <fmt/format.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rend {

namespace {

// Rubble thinner than this share of its rest volume and shape is crushed: contact is left to the
// grid, else a damaged element would freeze the time step.
constexpr Real kCrushed = 0.25;

// Largest eigenvalue of sum_q g_q g_q^T for shape gradients g_q, from D^-1 whose rows are g_1..g_3.
Real gradient_size(const Mat3& D_inverse) {
  const Vec3 g0 = D_inverse.colwise().sum();
  return symmetric_eigen(D_inverse.transpose() * D_inverse + g0 * g0.transpose()).value.maxCoeff();
}

bool is_crushed(const MeshElement& element, const Mat3& D, const Mat3& plastic_inverse) {
  const Mat3 F = D * element.rest_inverse;
  const Real thickness = 1 / std::sqrt(gradient_size(D.inverse()));
  const Real at_rest = 1 / std::sqrt(gradient_size(element.rest_inverse));
  return !((F * plastic_inverse).determinant() > 0 && F.determinant() > 0 &&
           thickness > kCrushed * at_rest);
}

}  // namespace

Mat3 element_edges(const Tet& t, const std::vector<Vec3>& x) {
  const Vec3& o = x[static_cast<std::size_t>(t[0])];
  Mat3 D;
  for (int k = 0; k < 3; ++k) D.col(k) = x[static_cast<std::size_t>(t[k + 1])] - o;
  return D;
}

MeshElements::MeshElements(const SceneDesc& scene, const Model& model) {
  const auto is_mesh = [&](std::size_t particle) {
    const std::size_t body = model.body[particle];
    return body < scene.bodies.size() && scene.bodies[body].force == ForceKind::mesh;
  };
  const std::size_t count = model.X.size();
  if (std::none_of(scene.bodies.begin(), scene.bodies.end(),
                   [](const BodyDesc& b) { return b.force == ForceKind::mesh; }))
    return;
  on_mesh.resize(count);
  for (std::size_t p = 0; p < count; ++p) on_mesh[p] = is_mesh(p);
  std::vector<Real> lumped(count, 0);
  for (const Tet& t : model.tets) {
    const auto first = static_cast<std::size_t>(t[0]);
    if (!on_mesh[first]) continue;
    const Mat3 D = element_edges(t, model.X);
    const Real volume = D.determinant() / 6;
    if (!(volume > 1e-9 * std::pow(D.norm(), 3)))
      throw Error(fmt::format("/bodies/{}", model.body[first]),
                  "has a flat tet; choose another particles_per_cell or seed");
    Real strength = 1;
    if (!model.strength.empty()) {
      strength = 0;
      for (Index v : t) strength += 0.25 * model.strength[static_cast<std::size_t>(v)];
    }
    elements.push_back({t, D.inverse(), volume, 1, strength, model.material[first]});
    for (Index v : t) lumped[static_cast<std::size_t>(v)] += volume / 4;
  }
  for (MeshElement& e : elements)
    for (Index v : e.corner)
      e.lightness = std::min(e.lightness, model.volume[static_cast<std::size_t>(v)] /
                                              lumped[static_cast<std::size_t>(v)]);

  first_use.assign(count + 1, 0);
  for (const MeshElement& e : elements)
    for (Index v : e.corner) ++first_use[static_cast<std::size_t>(v) + 1];
  std::partial_sum(first_use.begin(), first_use.end(), first_use.begin());
  uses.resize(4 * elements.size());
  std::vector<Index> next = first_use;
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (std::size_t k = 0; k < 4; ++k)
      uses[static_cast<std::size_t>(next[static_cast<std::size_t>(elements[e].corner[k])]++)] =
          static_cast<Index>(4 * e + k);
}

ElementUpdate update_element(const SolverMaterial& material, const MeshElement& element,
                             const Mat3& D, Mat3& plastic_inverse, Real& tau_c) {
  ElementUpdate out;
  const Mat3 F = D * element.rest_inverse;
  if (element_is_damaged(material, tau_c) && is_crushed(element, D, plastic_inverse)) return out;
  Mat3 elastic = F * plastic_inverse;
  const PointUpdate update =
      material.respond(material.constants, elastic, tau_c, material.tau_c0 * element.strength);
  out.tau = update.tau;
  out.yielded = update.yielded;
  out.clamped = update.clamped;
  out.dissipation = update.dissipation;
  // The clamp of a flat element is not plastic flow, and F has no inverse there.
  if (update.yielded && !update.clamped) plastic_inverse = F.inverse() * elastic;
  const Mat3 piola = update.tau * elastic.inverse().transpose() * plastic_inverse.transpose();
  out.pull = -element.volume * piola * element.rest_inverse.transpose();

  const Real stiffness =
      wave_stiffness(material.lame.mu, material.lame.lambda, update.least_stress);
  const Mat3 shape =
      update.clamped
          ? Mat3((elastic * plastic_inverse.inverse() * element.rest_inverse.inverse()).inverse())
          : Mat3(D.inverse());
  out.rate =
      std::sqrt(gradient_size(shape) * stiffness / (material.desc.density * element.lightness));
  return out;
}

Real element_energy_density(const SolverMaterial& material, const MeshElement& element,
                            const Mat3& D, const Mat3& plastic_inverse, Real tau_c) {
  const bool damaged = element_is_damaged(material, tau_c);
  if (damaged && is_crushed(element, D, plastic_inverse)) return 0;
  return elastic_energy_density(material.constants, D * element.rest_inverse * plastic_inverse,
                                damaged);
}

void VertexState::add(Real tau_c, Real tau_c0, bool element_damaged, bool element_yielded,
                      float largest) {
  const Real lost = element_damaged ? 1 : tau_c0 > 0 ? 1 - tau_c / tau_c0 : 0;
  damage = std::max(damage, static_cast<float>(std::clamp(lost, 0.0, 1.0)));
  stress = any ? std::max(stress, largest) : largest;
  yielded = yielded || element_yielded;
  damaged = damaged || element_damaged;
  any = true;
}

}  // namespace rend
