// The fast solver: explicit MPM in float, vectorised, one pass over the particles a step.
#pragma once

#include "engine/mpm/energy_balance.h"
#include "engine/mpm/fault.h"
#include "engine/mpm/solver.h"
#include "engine/mpm/tile_grid.h"
#include "engine/mpm/tile_island.h"
#include "engine/mpm/tile_kernel.h"
#include "engine/mpm/tile_mesh.h"
#include "engine/mpm/tile_store.h"
#include "engine/mpm/time_step.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace rend {

/// CPU seconds of the process that the stages of advance() have taken.
struct TileTimes {
  Real grid = 0, particles = 0, islands = 0, elements = 0, rebin = 0, legs = 0;
  Index steps = 0, rebins = 0;
};

/// A step reads the node rows of the last one: grid blocks sum them, then every particle block
/// gathers, responds and scatters for the next step in one go, so v and C are stored at the ends of
/// a frame only. Particles are re-binned when the guard says so: how far any of them is beyond its
/// block plus dt times the largest node velocity, which bounds every particle's motion because a
/// particle's velocity is a convex mean of node velocities.
class TileSolver : public Solver {
 public:
  /// Why the tile solver cannot run a scene; empty when it can.
  static std::string obstacle(const SceneDesc& scene);

  /// `kernels` picks an instruction set; nullptr is the one of tile_kernels().
  /// @throws Error for particles that are not finite or too far out. @pre obstacle(scene) is empty.
  TileSolver(const SceneDesc& scene, const Model& model, const TileKernels* kernels = nullptr);

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

  /// State of one particle in SI units, for comparisons.
  struct Point {
    Vec3 x, v;
    Mat3 C, strain;  ///< b^e - I
    Real tau_c;
  };
  std::vector<Point> points() const;  ///< by id
  const TileTimes& times() const { return times_; }
  /// Elements of bodies with mesh forces.
  const TileMesh& mesh() const { return mesh_; }
  /// Steps that particles have taken without the shared grid: single ones, and in islands.
  std::int64_t lone_steps() const { return lone_steps_; }
  std::int64_t island_steps() const { return island_steps_; }
  std::int64_t legs() const { return legs_; }

 private:
  struct Material {
    MaterialDesc desc;
    MaterialConstants constants;
    /// Wave stiffness over density of a run of this material [m2/s2].
    Real stiffness(const RunExtremes& extremes) const;
  };
  struct StepSums {
    MotionExtremes motion;
    Real dissipation = 0;
    Index clamped = 0;
    float excess = 0;
    Real fastest = 0;  ///< particle [cells/s]
    Real strayed = 0;  ///< largest velocity component of an island that free fall lacks [cells/s]
    bool finite = true;
    StepSums& operator+=(const StepSums& other);
  };
  // Everything that a bad frame must give back, and that a file must keep.
  struct State {
    TileStore::State store;
    TileMesh::State mesh;
    std::vector<float> motion;
    Real time = 0;
    EnergyBalance balance;
    MotionExtremes extremes;
    float excess = 0;
  };

  void place(const Model& model);
  MaterialConstants constants_of(const MaterialDesc& material) const;
  StepConstants step_constants(Pass pass, Real dt, Real next_dt) const;
  // Blocks that a pass is for.
  enum class Blocks { all, with_mesh, without_mesh };
  StepSums particle_pass(Pass pass, const StepConstants& step, Blocks which = Blocks::all);
  /// The same with forces of elements between gather and scatter; `next` is the step to come.
  StepSums mesh_pass(Pass pass, const StepConstants& step, Real next);
  void place_vertices();
  StepSums mesh_response();
  /// Vertices take the impulse of their elements in a step `dt` as velocity; with FLIP it waits
  /// where others carry C.
  void kick_vertices(Real dt);
  void add_mesh_materials();
  bool is_flip() const { return scene_.solver.transfer == Transfer::flip; }
  bool on_mesh(const TileRun& run) const { return materials_[run.material].constants.on_mesh; }
  bool meets_mesh(const TileBlock& block) const;
  std::vector<TileMesh::Law> laws_of(const std::vector<MaterialDesc>& materials) const;
  /// Which of materials_ a particle follows.
  std::uint16_t kind_of(std::uint16_t material, Index id) const;
  /// The digits of a vertex position that its lane has no room for.
  void set_low_position(const Vec3& cells, float* lane) const;
  template <class F>
  void each_vertex(F&& visit) const;
  StepSums sums_of(std::uint16_t material, const RunExtremes& extremes) const;
  StepSums island_pass(Pass pass, const StepConstants& step);
  Real exchange(Index task);
  StepSums every_particle(Pass pass, const StepConstants& step, Real next);
  /// Between legs all particles are in regular blocks, with v and C stored; within one, islands are
  /// on their own.
  void begin_leg(Real remaining);
  void end_leg();
  /// Whether a leg must end with the step of length `dt`, before particles may break what islands
  /// rely on in the `next` one.
  bool leg_ends(Real dt, Real next) const;
  Fault run_leg(Real begin, Real end, const BetweenSteps& between, FrameReport& report);
  /// Largest node velocity component [cells/s].
  Real grid_pass(Real dt);
  void make_room_for_motion();
  void update_topology();
  void measure_motion();
  /// Groups that `materials` need, after those of `layout`.
  TileLayout needed_layout(TileLayout layout, const std::vector<Material>& materials) const;
  void add_groups(const TileLayout& needed);
  /// The particle that most likely made a step fail: not finite, or farthest beyond its block.
  Index suspect() const;
  /// A particle with a value that is not finite; -1 when there is none.
  Index first_bad_particle() const;
  Fault farthest_block() const;
  State state() const;
  void restore(const State& state);
  void measure_energy(FrameReport& report) const;
  void fill_report(FrameReport& report);
  std::uint64_t state_hash() const;
  bool is_damaged(std::size_t material, float tau_c) const;
  Real tau_c0(std::size_t material, Index id) const;
  float* motion() const { return spare_.data(); }

  struct Lane;
  Lane lane(const TileRun& run, int i) const;
  float tau_c(const Lane& lane) const;
  Vec3 world_position(const TileBlock& block, const Lane& lane) const;
  // Per particle of a run, at the end of a frame.
  struct RunMeasure {
    std::vector<float> energy, stress, power;
  };
  RunMeasure measure(const TileRun& run) const;
  /// Calls visit(run, block) for every run.
  template <class F>
  void each_run(F&& visit) const;

  SceneDesc scene_;
  Real dx_;
  Real density_;  ///< reference [kg/m3]
  const TileKernels* kernels_;
  /// Of the scene; with mesh forces once more, for vertices of elements.
  std::vector<Material> materials_;
  std::vector<float> strength_;
  std::uint64_t scene_hash_ = 0;

  TileStore store_;
  mutable AlignedFloats spare_;  ///< v and C between frames, room to re-bin within one
  TileGrid grid_;
  TileMesh mesh_;
  IslandTiles islands_;
  // The leg under way: its bounds, and what has come of them.
  struct Leg {
    LegBounds bounds;
    Real time = 0;
    Real travel = 0, fastest = 0;    ///< of matter on the grid and colliders [cells, cells/s]
    Real strayed = 0, straying = 0;  ///< of islands [cells, cells/s]
  };
  Leg leg_;
  bool topology_fits_ = false;
  std::int64_t lone_steps_ = 0, island_steps_ = 0, legs_ = 0;
  bool stopped_ = false;  ///< between() has ended the advance
  std::vector<RunExtremes> run_extremes_;
  float excess_ = 0;
  MotionExtremes motion_;
  Vec3 gravity_;
  PullForce pull_;
  NodeRule node_rule_;
  Vec3f common_velocity_ = Vec3f::Zero();  ///< of the leg, see StepConstants [cells/s]
  Real time_ = 0;
  EnergyBalance balance_;
  Index frame_ = 0;
  FrameReport report_;
  State good_;
  TileTimes times_;
};

}  // namespace rend
