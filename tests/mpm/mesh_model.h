// Scenes with mesh forces.
#pragma once

#include "tests/mpm/kuhn_model.h"
#include "tests/mpm/lattice_model.h"

namespace rend {

/// plain_scene() with one body with mesh forces.
inline SceneDesc mesh_scene() {
  SceneDesc scene = plain_scene();
  BodyDesc body;
  body.force = ForceKind::mesh;
  scene.bodies.push_back(body);
  return scene;
}

}  // namespace rend
