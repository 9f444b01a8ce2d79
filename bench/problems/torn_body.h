// Bodies that two grips tear: what a crack takes, how large it is, how many pieces it leaves.
#pragma once

#include "bench/problems/trial.h"

#include <filesystem>
#include <string>

namespace rend {

struct Torn {
  Real dissipated = 0;  ///< [J]
  Real peak_force = 0;  ///< of the grips, from their work and way [N]
  Real crack_area = 0;  ///< one side of the crack faces at rest [m2]; only with a fracture mesh
  Index pieces = 0;     ///< only with a fracture mesh
  Index damaged = 0;    ///< particles
  Real modulus = 0;     ///< softening that the run had [Pa]
  RunCost cost;
};

/// Runs all frames of a scene whose first two colliders are the grips.
Torn tear(const SceneDesc& scene, const Model& model, bool with_fracture_mesh);

/// How the notched bar of the resolution study (E11) is torn, without gravity and strength field.
struct NotchRun {
  Real dx = 0.216;
  std::string softening = R"("softening": 3000)";
  bool mesh_force = false;
  int seed = 1;   ///< of the sampling
  int shift = 0;  ///< number of the random shift against the grid; 0 is none
  Real turn = 0;  ///< of the scene about z, that is of the grid against it [deg]
};
Torn tear_notched_bar(const std::filesystem::path& scenes, const NotchRun& run);

}  // namespace rend
