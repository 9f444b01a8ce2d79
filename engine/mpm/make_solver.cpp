// The choice between the solvers.
#include "engine/mpm/reference_solver.h"

namespace rend {

std::unique_ptr<Solver> make_solver(const SceneDesc& scene, const Model& model, std::string* why) {
  if (why) *why = "The reference solver runs every scene.";
  return std::make_unique<ReferenceSolver>(scene, model);
}

}  // namespace rend
