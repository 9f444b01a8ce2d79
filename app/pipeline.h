// Scene to frames: model, solver and fracture mesh in a row; used by the live session and by `rend run` alike.
#pragma once

#include "engine/fracture/fracture_mesh.h"
#include "engine/mesh/build_model.h"
#include "engine/mpm/solver.h"
#include "engine/scene/scene_desc.h"

#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace rend {

/// Everything that is known about one frame. Shared and immutable once made.
struct Frame {
  std::shared_ptr<const Snapshot> snapshot;
  std::shared_ptr<const SurfaceMesh> surface;
  std::shared_ptr<const std::vector<float>> nearness;  ///< #P share of the break threshold used up
  FractureReport fracture;
};

/// Updates the fracture mesh with the next snapshot and takes its surface.
Frame mesh_frame(FractureMesh& fracture, std::shared_ptr<const Snapshot> snapshot);

/// Owns the matter of one scene and advances it frame by frame.
class Pipeline {
 public:
  /// Starts `scene` on matter that was built for it.
  Pipeline(SceneDesc scene, std::shared_ptr<const Model> model);

  /// The state as it stands, without advancing: frame 0 after construction.
  Frame current();

  /// Advances by one frame of the scene's frame rate. A bad status in the report means that the run is over and
  /// the frame shows the last good state. An advance that `between` ended early returns an empty frame.
  Frame advance(const BetweenSteps& between = {});

  /// Applies new material values and gravity; may be called between two advances.
  void apply(const SceneDesc& changed);

  /// Starts the fracture mesh again with other settings and replays `recorded` (frames in order); each gets its new
  /// surface.
  void remesh(const FractureDesc& settings, std::vector<Frame>& recorded);

  void set_pull(const PullForce& pull) { solver_->set_pull(pull); }
  const PullForce& pull() const { return solver_->pull(); }

  const SceneDesc& scene() const { return scene_; }
  const Model& model() const { return *model_; }
  const Solver& solver() const { return *solver_; }
  const std::string& solver_choice() const { return solver_choice_; }

  void save(std::ostream& out) const { solver_->save(out); }

  /// Goes on after `frame` from a saved state, with the same bits: recorded(n) gives back the snapshots of frames
  /// 1..frame, from which the fracture mesh learns again what broke. @throws Error when one of them does not fit.
  void resume(Index frame, std::istream& state, const std::function<Snapshot(Index)>& recorded);

 private:
  Frame make_frame(FrameReport report);

  SceneDesc scene_;
  std::shared_ptr<const Model> model_;
  std::string solver_choice_;
  std::unique_ptr<Solver> solver_;
  FractureMesh fracture_;
  Index frame_ = 0;
  Real frame_end_ = 0;  ///< time at which the frame in hand ends [s]
};

}  // namespace rend
