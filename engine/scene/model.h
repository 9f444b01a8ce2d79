// A scene made into matter: particles at rest, the tets between them, and what they are made of.
#pragma once

#include "engine/core/types.h"

#include <cstdint>
#include <string>
#include <vector>

namespace rend {

/// All particles of a scene with stable ids 0..#P-1, and one tet mesh over them.
/// Rest positions are world positions at time 0. Particle mode: tets only serve the fracture mesh. Mesh mode
/// (ForceKind::mesh): they also carry the energy.
struct Model {
  std::vector<Vec3> X;                    ///< #P rest positions [m]
  std::vector<Real> volume;               ///< #P rest volumes [m3]
  std::vector<Vec3> velocity;             ///< #P initial velocities [m/s]
  std::vector<Mat3> velocity_gradient;    ///< one per body [1/s]
  std::vector<std::uint16_t> body;        ///< #P index into SceneDesc::bodies
  std::vector<std::uint16_t> material;    ///< #P index into SceneDesc::materials
  std::vector<float> strength;            ///< #P factor on tau_c [-]; empty when every material is uniform
  std::vector<Tet> tets;                  ///< positively oriented, indices into X
  std::vector<Triangle> skin;             ///< boundary faces of the tets, outward
  std::vector<std::uint8_t> crease;       ///< #P: 1 where the input surface has a sharp edge or corner
  std::vector<Real> spacing;              ///< one per body: target distance of particles [m]
  std::vector<std::string> notes;         ///< what was repaired or left out, for the user

  Index particle_count() const { return static_cast<Index>(X.size()); }
};

}  // namespace rend
