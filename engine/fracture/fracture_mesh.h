// Turns particles of successive frames into a fracture mesh: topology that evolves, extrapolated positions,
// smoothed crack faces (Wang's three post-process steps).
#pragma once

#include "engine/fracture/surface_mesh.h"
#include "engine/mpm/snapshot.h"
#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

#include <memory>

namespace rend {

/// How much is broken, for frames.csv and the page.
struct FractureReport {
  Index broken_edges = 0;
  Index pieces = 0;         ///< components through unbroken edges
  Index new_broken = 0;     ///< edges broken by the last update
  Real seconds = 0;         ///< wall time of the last update and surface
};

/// Keeps the broken set of a run. Snapshots must come in the order of their frames; any earlier frame can be rebuilt
/// from the frame in which each edge broke.
class FractureMesh {
 public:
  FractureMesh(const SceneDesc& scene, const Model& model);
  ~FractureMesh();
  FractureMesh(FractureMesh&&) noexcept;
  FractureMesh& operator=(FractureMesh&&) noexcept;

  /// Breaks edges by the test of the scene. O(#edges), and work only where something broke.
  void update(const Snapshot& snapshot);

  /// The surface for the broken set as it stands and the positions of `snapshot`.
  SurfaceMesh surface(const Snapshot& snapshot) const;

  FractureReport report() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rend
