// The tets that carry energy: who they join, what they are at rest, and one element's response.
#pragma once

#include "engine/mpm/solver_material.h"
#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

#include <vector>

namespace rend {

/// One tet at rest.
struct MeshElement {
  Tet corner;
  Mat3 rest_inverse;  ///< D_m^-1, the edges from corner 0 as columns of D_m
  Real volume;
  Real lightness;  ///< least share of lumped mass that a vertex really has
  Real strength;   ///< factor on tau_c
  std::uint16_t material;
};

/// The tets of all bodies with mesh forces, and which of them every particle belongs to.
struct MeshElements {
  /// @throws Error naming the body of a tet that is flat or turned inside out at rest.
  MeshElements(const SceneDesc& scene, const Model& model);

  bool empty() const { return elements.empty(); }
  /// Whether the energy of this particle is on the mesh.
  bool carries(Index particle) const {
    return !on_mesh.empty() && on_mesh[static_cast<std::size_t>(particle)] != 0;
  }

  std::vector<MeshElement> elements;
  std::vector<std::uint8_t> on_mesh;  ///< per particle; empty without mesh forces
  std::vector<Index> first_use;       ///< per particle + 1, into uses
  std::vector<Index> uses;            ///< 4 * element + corner, ascending
};

/// Edges from corner 0 as columns.
Mat3 element_edges(const Tet& corner, const std::vector<Vec3>& x);

/// What one evaluation makes of an element. A damaged element that is flat or inverted carries
/// nothing.
struct ElementUpdate {
  Mat3 tau = Mat3::Zero();   ///< Kirchhoff stress [Pa]
  Mat3 pull = Mat3::Zero();  ///< forces on corners 1, 2, 3 as columns, -V_e P_e grad N
  Real rate = 0;             ///< bound of omega / 2, sqrt of 1 / length of D times [m/s]
  Real dissipation = 0;      ///< per rest volume [J/m3]
  bool yielded = false, clamped = false;
};

/// Return mapping of an element with edges D, then P_e = tau F_e^-T F_p^-T. The rate bounds the
/// element eigenvalue at the current shape, 4 |sum_q g_q g_q^T| (stiffness / rho).
ElementUpdate update_element(const SolverMaterial& material, const MeshElement& element,
                             const Mat3& D, Mat3& plastic_inverse, Real& tau_c);

/// Energy per rest volume [J/m3]; 0 for crushed rubble.
Real element_energy_density(const SolverMaterial& material, const MeshElement& element,
                            const Mat3& D, const Mat3& plastic_inverse, Real tau_c);

inline bool element_is_damaged(const SolverMaterial& material, Real tau_c) {
  return material.desc.damage.type != DamageType::off && !(tau_c > 0);
}

/// Extremes over the elements at one vertex.
struct VertexState {
  float damage = 0;  ///< 1 - tau_c / tau_c0, 1 when damaged
  float stress = 0;  ///< largest principal Kirchhoff stress [Pa]
  bool yielded = false, damaged = false;
  bool any = false;  ///< an element has been added

  void add(Real tau_c, Real tau_c0, bool element_damaged, bool element_yielded, float largest);
};

}  // namespace rend
