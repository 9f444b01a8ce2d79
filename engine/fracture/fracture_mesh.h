// Turns particles of successive frames into a fracture mesh: topology that evolves, extrapolated
// positions, smoothed crack faces (Wang's three post-process steps).
#pragma once

#include "engine/fracture/surface_mesh.h"
#include "engine/mpm/snapshot.h"
#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

#include <Eigen/Geometry>
#include <memory>
#include <vector>

namespace rend {

/// How much is broken, for frames.csv and the page.
struct FractureReport {
  Index broken_edges = 0;
  Index pieces = 0;      ///< components through unbroken edges
  Index new_broken = 0;  ///< edges broken by the last update
  Real seconds = 0;      ///< wall time of the last update and surface
};

/// Where the time of the last update and surface went, CPU time of the process [s]; for benchmarks.
struct FractureStages {
  Real test = 0;       ///< break test of all edges
  Real cut = 0;        ///< new copies and triangles of changed tets
  Real smooth = 0;     ///< rest positions of new crack vertices
  Real pieces = 0;     ///< components
  Real rotations = 0;  ///< of particles near cracks
  Real positions = 0;  ///< positions and fields of all vertices
  Real triangles = 0;
  Real normals = 0;
  Real sum() const {
    return test + cut + smooth + pieces + rotations + positions + triangles + normals;
  }
};

/// When every edge broke: all that is needed to play a run back, and to smooth it knowing how it
/// ends.
struct BreakTable {
  std::vector<Edge> edge;    ///< ends, lower particle first
  std::vector<Index> frame;  ///< Snapshot::frame in which it broke
  std::vector<Index> loose;  ///< particles without any unbroken edge, and how they were turned when
                             ///< they came loose
  std::vector<Eigen::Quaterniond> loose_rotation;
};

/// Keeps the broken set of a run. Snapshots must come in the order of their frames; any earlier
/// frame can be rebuilt from the frame in which each edge broke.
class FractureMesh {
 public:
  /// @throws Error at `model` when the tets are not a mesh (see tet_tables.h).
  FractureMesh(const SceneDesc& scene, const Model& model);
  /// Plays a table back instead of testing edges: crack faces lie where the complete table puts
  /// them, so nothing ever shifts between frames, and frames may be asked for in any order. @throws
  /// Error when an edge does not exist.
  FractureMesh(const SceneDesc& scene, const Model& model, const BreakTable& table);
  ~FractureMesh();
  FractureMesh(FractureMesh&&) noexcept;
  FractureMesh& operator=(FractureMesh&&) noexcept;

  /// Nothing broken yet, other settings, the same tables: for running recorded snapshots again.
  FractureMesh fresh(const FractureDesc& settings) const;
  /// The same with a table to play back.
  FractureMesh playback(const BreakTable& table) const;

  /// Materials changed while the scene runs: what they bear elastically decides what breaks next.
  void set_materials(const std::vector<MaterialDesc>& materials);

  /// Breaks edges by the test of the scene. O(#edges), and work only where something broke.
  /// @throws Error at `snapshot` when it has another number of particles than the model.
  void update(const Snapshot& snapshot);

  /// The surface for the broken set as it stands and the positions of `snapshot`.
  SurfaceMesh surface(const Snapshot& snapshot) const;
  /// The same into `mesh`, whose memory is used again.
  void surface(const Snapshot& snapshot, SurfaceMesh& mesh) const;

  /// #P share of the break threshold used up in the last update, see break_criterion.h; a playback
  /// tests nothing and shows what it is given.
  const std::vector<float>& nearness() const;
  void set_nearness(std::vector<float> nearness);

  FractureReport report() const;
  FractureStages stages() const;
  BreakTable break_table() const;

  /// The broken set itself, and the memory of it all [bytes per particle]; for tests and
  /// benchmarks.
  const class CrackMesh& crack() const;
  double bytes_per_particle() const;

 private:
  struct State;
  explicit FractureMesh(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace rend
