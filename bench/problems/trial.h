// One run of a problem: the solver of its precision, particle states read back from it, and what it
// costs.
#pragma once

#include "engine/mpm/solver.h"

#include <memory>
#include <numbers>
#include <vector>

namespace rend {

inline constexpr Real kPi = std::numbers::pi;

/// Positions, velocities, Kirchhoff stresses, affine velocities (empty when the scheme has none)
/// and yield thresholds by particle id.
struct Matter {
  std::vector<Vec3> x, v;
  std::vector<Mat3> tau, C;
  std::vector<Real> tau_c;
};

/// What the steps of a run took, frame reports included.
struct RunCost {
  Index particles = 0, steps = 0;
  Real cpu_seconds = 0, wall_seconds = 0;  ///< CPU of all threads
  Real bytes_per_particle = 0;
  Status status = Status::ok;

  Real particle_steps() const { return static_cast<Real>(particles) * static_cast<Real>(steps); }
};

/// A scene on its way.
class Trial {
 public:
  Trial(const SceneDesc& scene, const Model& model);

  Solver& operator*() { return *solver_; }
  Solver* operator->() { return solver_.get(); }

  /// Solver::advance() on the clock.
  FrameReport advance(Real duration);
  const RunCost& cost() const { return cost_; }

  /// Stress of the tile solver is that of its elastic strain: right until something is damaged.
  Matter matter() const;

 private:
  SceneDesc scene_;
  std::unique_ptr<Solver> solver_;
  RunCost cost_;
};

/// A rule that keeps matter in the directions of `free`: 1 lets the component be, 0 stops it. A
/// single layer of particles then moves exactly as in one or two dimensions (plane strain), since
/// weights are products.
inline NodeRule only_along(const Vec3& free) {
  return [free](const Vec3&, Real, Real, const Vec3& v) { return Vec3(v.cwiseProduct(free)); };
}

}  // namespace rend
