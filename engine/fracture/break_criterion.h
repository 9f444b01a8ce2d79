// Which edges break in a frame: by their stretch, or by how far they open against the rigid motion
// of their ends.
#pragma once

#include "engine/fracture/crack_mesh.h"
#include "engine/fracture/rotation_field.h"
#include "engine/mpm/snapshot.h"
#include "engine/scene/scene_desc.h"

#include <vector>

namespace rend {

/// Stretch: |x_ab| > s |X_ab|, with "auto" s = max(1.5, 1.3 exp(tau_c0 / E)) of the tougher end.
/// Gap: |x_ab - M X_ab| > gap h max(1, |M X_ab| / |X_ab|) + (exp((1 - damage) tau_c0 / E) - 1)
/// |X_ab|, h the mean edge length of the body, M = (M_a + M_b) / 2, M_a = R_a + (1 - damage_a)
/// (F_a - R_a), R and F the rotation and the affine map fitted robustly over unbroken neighbours.
/// Matter that keeps its strength flows: only neighbours that part from a common affine motion
/// are torn. Matter that has lost it is rigid debris. Looked at only where an end is damaged or has
/// yielded, so that elastic strain never cuts; elsewhere, far out, |x_ab| > 2 s |X_ab|.
class BreakCriterion {
 public:
  BreakCriterion(const SceneDesc& scene, const Model& model, const TetTables& tables);

  void set(const FractureDesc& settings);
  /// What the materials bear elastically from now on; as many as in the scene.
  void set_materials(const std::vector<MaterialDesc>& materials);

  struct Verdict {
    std::vector<Index> edges;  ///< ids of edges to break now, ascending
    /// #P largest share of its threshold that an edge of the particle has used up, in [0, 1]: of
    /// the allowed gap, or (stretch - 1) / (s - 1); 0 where lengths changed by less than a tenth.
    std::vector<float> nearness;
  };
  /// `rotations` lends and keeps the rotations of the particles it looks at.
  Verdict find(const Snapshot& snapshot, const CrackMesh& crack, RotationField& rotations) const;

  /// Stretch that breaks an edge in material `m`.
  Real stretch_of(std::size_t m) const { return stretch_[m]; }

 private:
  struct Suspects {
    std::vector<Index> broken;   ///< edges far beyond any stretch
    std::vector<Edge> strained;  ///< ends of edges worth a closer look
  };
  Suspects scan_edges(const Snapshot& snapshot, const CrackMesh& crack) const;
  void find_gaps(const Snapshot& snapshot, const CrackMesh& crack,
                 const std::vector<Edge>& strained, RotationField& rotations,
                 Verdict& verdict) const;
  void find_stretch_shares(const Snapshot& snapshot, const std::vector<Edge>& strained,
                           std::vector<float>& nearness) const;

  const TetTables* tables_;  // not owned
  FractureDesc settings_;
  std::vector<std::uint16_t> material_;  ///< #P
  std::vector<float> strength_;          ///< #P, or empty
  std::vector<Real> stretch_;            ///< per material [-]
  std::vector<Real> yield_strain_;       ///< per material tau_c0 / E in uniaxial stress [-]
};

}  // namespace rend
