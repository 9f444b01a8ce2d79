// The reference solver: explicit MPM in double precision, every scheme, the oracle of the tile
// solver.
#pragma once

#include "engine/mpm/block_grid.h"
#include "engine/mpm/energy_balance.h"
#include "engine/mpm/fault.h"
#include "engine/mpm/grid_transfer.h"
#include "engine/mpm/mesh_force.h"
#include "engine/mpm/particles.h"
#include "engine/mpm/solver.h"
#include "engine/mpm/time_step.h"

#include <utility>
#include <vector>

namespace rend {

/// The exponent E of F <- exp(E) F for H = dt grad v: H - W^2 / 2 with W = skew H. Positions move
/// with 1 + H, which for a turn R is R; exp(R - 1) shrinks by the square of the angle, so that
/// spinning bodies would swell step by step, and E takes that back up to the fourth order. The
/// isotropic mode, which sets the stable step, has no W.
Mat3 step_exponent(const Mat3& H);

class ReferenceSolver : public Solver {
 public:
  /// @throws Error for particles that are not finite or outside +-2^20 cells, and for flat tets
  /// that carry forces.
  ReferenceSolver(const SceneDesc& scene, const Model& model);

  FrameReport advance(Real duration, const BetweenSteps& between = {}) override;
  Real time() const override { return time_; }
  Snapshot snapshot() const override;
  void set_material(std::size_t index, const MaterialDesc& material) override;
  void set_gravity(const Vec3& gravity) override;
  void set_pull(const PullForce& pull) override { pull_ = pull; }
  const PullForce& pull() const override { return pull_; }
  void set_node_rule(NodeRule rule) override { node_rule_ = std::move(rule); }
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;
  std::string describe() const override;
  double bytes_per_particle() const override;

  const Particles& particles() const { return particles_; }
  const MeshState& mesh_state() const { return mesh_.state(); }
  /// Largest step that the rule of time_step.h allows now [s].
  Real stable_time_step() const;

 private:
  // What one step adds up over particles.
  struct StepSums {
    MotionExtremes motion;
    Real dissipation = 0;
    Index clamped = 0;
    Fault fault;
    StepSums& operator+=(const StepSums& other);
  };

  // Everything that a bad frame must give back.
  struct State {
    Particles particles;
    MeshState mesh;
    Real time = 0;
    EnergyBalance balance;
    MotionExtremes motion;
  };

  StepSums step(Real dt);
  void bin_particles();
  void particles_to_grid();
  void update_grid(Real dt);
  StepSums grid_to_particles(Real dt);
  void evaluate_mesh(StepSums& sums);

  void move_particle(Index p, const GridSample& sample, Real dt, StepSums& sums);
  void respond(Index p, StepSums& sums);
  void watch(Index p, const Vec3& displacement, Real dt, StepSums& sums) const;
  void measure_motion();
  bool is_damaged(Index p) const;
  Real tau_c0(Index p) const;
  bool inside_domain(const Vec3& x) const;
  Fault first_bad_particle() const;
  void remember();
  void restore();
  void measure_energy(FrameReport& report) const;
  void fill_report(FrameReport& report);
  std::uint64_t state_hash() const;

  SceneDesc scene_;
  Real dx_;
  GridTransfer transfer_;
  std::vector<SolverMaterial> materials_;
  std::vector<float> strength_;
  std::uint64_t scene_hash_ = 0;

  Particles particles_;
  MeshForce mesh_;
  BlockGrid grid_;
  std::vector<Vec3i> first_node_;
  Vec3 gravity_;
  PullForce pull_;
  NodeRule node_rule_;
  Real time_ = 0;
  EnergyBalance balance_;
  MotionExtremes motion_;
  Index frame_ = 0;
  FrameReport report_;
  State good_;
};

}  // namespace rend
