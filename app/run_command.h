// `rend run` and `rend remesh`: a scene to pictures, meshes and a table, without a browser.
#pragma once

#include "app/run_directory.h"
#include "engine/scene/scene_desc.h"

namespace rend {

struct RunOptions {
  int frames = 0;            ///< in all; 0: as many as the scene says
  int checkpoint_every = 0;  ///< frames between two checkpoints; 0: none
  bool resume = false;       ///< go on from the newest whole checkpoint of the run directory
  OutputOptions output;
};

/// Runs the scene into a run directory. Returns the exit code: 0, or 4 when the run stopped with a named reason.
/// @throws Error when the directory cannot be used, or when it holds nothing to resume from.
int run_scene(const SceneDesc& scene, const RunOptions& options);

/// Makes surfaces and pictures again from the particles recorded in `run_directory`, with the fracture settings, camera
/// and colours of `scene`; nothing is simulated. `only` names the frames to write, empty is all. @throws Error when nothing was recorded or it does not fit.
int remesh_run(const SceneDesc& scene, const std::filesystem::path& run_directory, const OutputOptions& options,
               const std::vector<int>& only = {});

}  // namespace rend
