// The fracture mesh of one frame: a closed, oriented 2-manifold surface with what one wants to see
// on it.
#pragma once

#include "engine/core/types.h"

#include <cstdint>
#include <vector>

namespace rend {

/// Vertices are shared between triangles wherever the surface is connected, so the mesh is closed
/// as it stands. All vertex arrays have length #V, all triangle arrays #T.
struct SurfaceMesh {
  std::vector<Vec3> x;     ///< positions [m]
  std::vector<Vec3> rest;  ///< rest positions [m]
  std::vector<Vec3f>
      normal;  ///< smooth unit normals that do not average over creases or crack rims
  std::vector<float> damage;    ///< [-]
  std::vector<float> stress;    ///< largest principal Kirchhoff stress [Pa]
  std::vector<float> speed;     ///< [m/s]
  std::vector<float> nearness;  ///< share of the break threshold used up [-], see break_criterion.h
  std::vector<std::uint8_t>
      crease;  ///< 1 where corners need normals of their own (sharp edge or crack rim)
  std::vector<Triangle> triangles;     ///< counter-clockwise seen from outside
  std::vector<std::uint8_t> interior;  ///< #T: 1 for crack faces, 0 for skin
  std::vector<Index> piece;            ///< #T: stable fragment id

  Index vertex_count() const { return static_cast<Index>(x.size()); }
  Index triangle_count() const { return static_cast<Index>(triangles.size()); }
};

/// Enclosed volume [m3] by the divergence theorem.
Real enclosed_volume(const SurfaceMesh& mesh);

}  // namespace rend
