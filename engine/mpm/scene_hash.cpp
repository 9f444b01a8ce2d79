// Hash of the parts of a scene that a saved state depends on.
#include "engine/mpm/scene_hash.h"

#include "engine/mpm/state_file.h"

namespace rend {

std::uint64_t hash_scene(const SceneDesc& scene, const Model& model) {
  const Real numbers[] = {scene.grid.dx, static_cast<Real>(scene.solver.transfer),
                          static_cast<Real>(scene.solver.kernel),
                          static_cast<Real>(scene.solver.force_form),
                          static_cast<Real>(scene.solver.deformation_update)};
  std::uint64_t hash = hash_bytes(1, numbers, sizeof(numbers));
  hash = hash_values(hash, model.X);
  hash = hash_values(hash, model.volume);
  hash = hash_values(hash, model.strength);
  return hash_values(hash, model.material);
}

}  // namespace rend
