// `rend run`: a scene to pictures, meshes and a table, without a browser.
#pragma once

#include "engine/scene/scene_desc.h"
#include "render/renderer.h"

#include <filesystem>

namespace rend {

struct RunOptions {
  std::filesystem::path out;
  int frames = 0;              ///< 0: as many as the scene says
  bool png = true, ply = true;
  int width = 1280, height = 720;
  int accumulate = 8;          ///< render passes per picture
  int png_level = 1;
  GlBackend gl = GlBackend::automatic;
};

/// Runs the scene into a run directory (scene.json, frames.csv, png/, mesh/, particles/). Returns the exit code:
/// 0, or 4 when the run stopped with a named reason. @throws Error when the directory cannot be used.
int run_scene(const SceneDesc& scene, const RunOptions& options);

}  // namespace rend
