// Lagrangian energy: forces of a tet mesh whose vertices are the particles.
#pragma once

#include "engine/mpm/solver_material.h"
#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

#include <vector>

namespace rend {

/// What elements remember; one entry per element.
struct MeshState {
  std::vector<Mat3> plastic_inverse;  ///< F_p^-1 [-]
  std::vector<Mat3> tau;              ///< Kirchhoff stress [Pa]
  std::vector<Real> tau_c;            ///< state of the material law, see material_response
  std::vector<std::uint8_t> yielded;  ///< 1 when it has ever yielded
};

/// Phi = sum_e V_e psi(F_e F_p^-1) with F_e = D_s D_m^-1 on the tets of all bodies with mesh forces
/// (Lagrangian MPM, Jiang et al. 2015). Deformation comes from positions, so matter never comes
/// apart numerically; it fails where elements are damaged.
class MeshForce {
 public:
  /// @throws Error naming the body of a tet that is flat or turned inside out at rest.
  MeshForce(const SceneDesc& scene, const Model& model,
            const std::vector<SolverMaterial>& materials);

  bool empty() const { return elements_.empty(); }
  /// Whether the energy of this particle is on the mesh.
  bool carries(Index particle) const {
    return !on_mesh_.empty() && on_mesh_[static_cast<std::size_t>(particle)] != 0;
  }

  /// What one evaluation adds up.
  struct Sums {
    Real dissipation = 0;  ///< [J]
    Real rate = 0;         ///< largest bound of omega / 2 over elements [1/s]: dt <= 1 / rate
    Index clamped = 0;     ///< flat or inverted elements
    Sums& operator+=(const Sums& other);
  };

  /// Return mapping of every element at positions x, then f_q = -sum_e V_e P_e grad N_q [N] with
  /// P_e = tau F_E^-T F_p^-T. A damaged element that is flat or inverted carries nothing. The rate
  /// bounds the element eigenvalue at the current shape, 4 |sum_q g_q g_q^T| (stiffness / rho); the
  /// grid never raises it, since weights are convex.
  Sums evaluate(const std::vector<SolverMaterial>& materials, const std::vector<Vec3>& x,
                std::vector<Vec3>& force);

  Real elastic_energy(const std::vector<SolverMaterial>& materials,
                      const std::vector<Vec3>& x) const;

  /// Extremes over the elements at each vertex.
  struct VertexState {
    float damage = 0;  ///< 1 - tau_c / tau_c0, 1 when damaged
    float stress = 0;  ///< largest principal Kirchhoff stress [Pa]
    bool yielded = false, damaged = false;
  };
  VertexState at_vertex(const std::vector<SolverMaterial>& materials, Index particle) const;

  /// Scales thresholds of a material from tau_c0 = `before` to its present one.
  void rescale_thresholds(const std::vector<SolverMaterial>& materials, std::size_t material,
                          Real before);

  const MeshState& state() const { return state_; }
  void set_state(MeshState state) { state_ = std::move(state); }
  std::size_t element_count() const { return elements_.size(); }
  double bytes() const;

 private:
  struct Element {
    Tet corner;
    Mat3 rest_inverse;  // D_m^-1
    Real volume;
    Real lightness;  // least share of lumped mass that a vertex really has
    Real strength;
    std::uint16_t material;
  };

  Real tau_c0(const std::vector<SolverMaterial>& materials, std::size_t e) const {
    return materials[elements_[e].material].tau_c0 * elements_[e].strength;
  }
  bool is_damaged(const std::vector<SolverMaterial>& materials, std::size_t e) const;
  Sums evaluate_element(const std::vector<SolverMaterial>& materials, const std::vector<Vec3>& x,
                        std::size_t e);

  std::vector<Element> elements_;
  std::vector<std::uint8_t> on_mesh_;  // per particle
  std::vector<Index> first_use_;       // per particle + 1, into uses_
  std::vector<Index> uses_;            // 4 * element + corner, ascending
  std::vector<Mat3> pull_;             // per element: forces on corners 1, 2, 3 as columns [N]
  MeshState state_;
};

}  // namespace rend
