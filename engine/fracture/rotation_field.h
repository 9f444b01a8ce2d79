// Rotations of the particles near a crack, carried from frame to frame.
#pragma once

#include "engine/fracture/crack_mesh.h"
#include "engine/fracture/rotation.h"

#include <span>
#include <vector>

namespace rend {

/// Holds a rotation for every particle that was ever asked for: fitted over unbroken neighbours,
/// kept as it was for a particle that has none left.
class RotationField {
 public:
  explicit RotationField(Index particles) : slot_(static_cast<std::size_t>(particles), -1) {}

  bool known(Index p) const { return slot_[p] >= 0; }
  /// The rotation kept for p; identity when there is none.
  Eigen::Quaterniond of(Index p) const {
    return known(p) ? rotation_[slot_[p]] : Eigen::Quaterniond::Identity();
  }
  /// Slots of known particles are 0..slot_count()-1, in the order in which they were first asked
  /// for.
  Index slot(Index p) const { return slot_[p]; }
  Index slot_count() const { return static_cast<Index>(rotation_.size()); }
  double bytes() const { return 4. * static_cast<double>(slot_.size()) + 32. * slot_count(); }
  void set(Index p, const Eigen::Quaterniond& q);

  /// Least-squares fits for `particles` at positions x. O(#particles), parallel.
  void fit(std::span<const Index> particles, std::span<const Vec3> x, const CrackMesh& crack);
  /// Fits that let go of neighbours which do not move along (weights 1 / (1 + (misfit / scale)^2),
  /// two to four rounds), for telling an opening crack from the motion of its faces.
  void fit_robust(std::span<const Index> particles, std::span<const Vec3> x,
                  const CrackMesh& crack);

 private:
  void reserve(std::span<const Index> particles);
  std::vector<Index> slot_;  ///< #P
  std::vector<Eigen::Quaterniond> rotation_;
};

/// The affine map x_ab = F X_ab of the unbroken neighbours of p that come along (weights as above,
/// but the scale is no less than the misfit of the nearest quarter; four rounds from `rotation`).
/// It is drawn to `rotation` by 3 % of the strain, and all the way in directions in which
/// neighbours say nothing.
Mat3 fit_affine_robust(Index p, std::span<const Vec3> x, const CrackMesh& crack,
                       const Mat3& rotation);

}  // namespace rend
