// The interface of both solvers: advance, look, steer, save.
#pragma once

#include "engine/mpm/pull.h"
#include "engine/mpm/snapshot.h"
#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

#include <functional>
#include <iosfwd>
#include <memory>

namespace rend {

/// Called between two substeps; returning false ends the advance early (the frame is not complete
/// then).
using BetweenSteps = std::function<bool()>;

/// Velocity [m/s] of a grid node at x [m] at the end `time` [s] of a step of length dt, given its
/// velocity v after forces, gravity, pull and contact; called on any thread.
using NodeRule = std::function<Vec3(const Vec3& x, Real time, Real dt, const Vec3& v)>;

class Solver {
 public:
  virtual ~Solver() = default;

  /// Steps until time() has grown by `duration` [s], with a step chosen by the rule of time_step.h.
  /// On numerical trouble it stops with a named reason in the report and the state of the last good
  /// frame is restored.
  virtual FrameReport advance(Real duration, const BetweenSteps& between = {}) = 0;

  virtual Real time() const = 0;
  virtual Snapshot snapshot() const = 0;

  /// Changes a material between two advances; thresholds that have softened scale with the new tau_c.
  virtual void set_material(std::size_t index, const MaterialDesc& material) = 0;
  virtual void set_gravity(const Vec3& gravity) = 0;
  virtual void set_pull(const PullForce& pull) = 0;
  /// The pull as it stands: the grip of a spring has moved.
  virtual const PullForce& pull() const = 0;
  /// A body force or boundary condition that no scene describes, as manufactured solutions need; an
  /// empty rule is off. Not part of save().
  virtual void set_node_rule(NodeRule rule) = 0;

  /// Exact binary state; load() of the same scene continues with the same bits. @throws Error when
  /// it does not fit.
  virtual void save(std::ostream& out) const = 0;
  virtual void load(std::istream& in) = 0;

  /// Name of the solver and instruction set in use, and bytes it holds per particle; for `rend
  /// check`.
  virtual std::string describe() const = 0;
  virtual double bytes_per_particle() const = 0;
};

/// Picks the tile solver for "float" scenes that it covers and the reference solver otherwise;
/// `why` (optional) receives one sentence on the choice.
std::unique_ptr<Solver> make_solver(const SceneDesc& scene, const Model& model,
                                    std::string* why = nullptr);

}  // namespace rend
