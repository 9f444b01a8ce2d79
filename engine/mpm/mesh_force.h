// Lagrangian energy: forces of a tet mesh whose vertices are the particles.
#pragma once

#include "engine/mpm/mesh_elements.h"

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

  bool empty() const { return mesh_.empty(); }
  /// Whether the energy of this particle is on the mesh.
  bool carries(Index particle) const { return mesh_.carries(particle); }

  /// What one evaluation adds up.
  struct Sums {
    Real dissipation = 0;  ///< [J]
    Real rate = 0;         ///< largest bound of omega / 2 over elements [1/s]: dt <= 1 / rate
    Index clamped = 0;     ///< flat or inverted elements
    Sums& operator+=(const Sums& other);
  };

  /// Return mapping of every element at positions x, then f_q = -sum_e V_e P_e grad N_q [N]; see
  /// update_element. The grid never raises the rate, since weights are convex.
  Sums evaluate(const std::vector<SolverMaterial>& materials, const std::vector<Vec3>& x,
                std::vector<Vec3>& force);

  Real elastic_energy(const std::vector<SolverMaterial>& materials,
                      const std::vector<Vec3>& x) const;

  VertexState at_vertex(const std::vector<SolverMaterial>& materials, Index particle) const;

  /// Scales thresholds of a material from tau_c0 = `before` to its present one.
  void rescale_thresholds(const std::vector<SolverMaterial>& materials, std::size_t material,
                          Real before);

  const MeshState& state() const { return state_; }
  void set_state(MeshState state) { state_ = std::move(state); }
  std::size_t element_count() const { return mesh_.elements.size(); }
  double bytes() const;

 private:
  Real tau_c0(const std::vector<SolverMaterial>& materials, std::size_t e) const {
    return materials[mesh_.elements[e].material].tau_c0 * mesh_.elements[e].strength;
  }

  MeshElements mesh_;
  std::vector<Mat3> pull_;  // per element: forces on corners 1, 2, 3 as columns [N]
  MeshState state_;
};

}  // namespace rend
