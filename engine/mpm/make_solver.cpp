// The choice between the solvers.
#include "engine/mpm/reference_solver.h"
#include "engine/mpm/tile_solver.h"

#include <fmt/format.h>

namespace rend {

std::unique_ptr<Solver> make_solver(const SceneDesc& scene, const Model& model, std::string* why) {
  const std::string obstacle = TileSolver::obstacle(scene);
  if (obstacle.empty()) {
    if (why) *why = fmt::format("The tile solver runs this scene with {}.", tile_kernels()->name);
    return std::make_unique<TileSolver>(scene, model);
  }
  if (why) *why = fmt::format("The reference solver runs this scene: {}.", obstacle);
  return std::make_unique<ReferenceSolver>(scene, model);
}

}  // namespace rend
