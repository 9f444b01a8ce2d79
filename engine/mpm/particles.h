// The particles of the reference solver, in the order of their stable ids.
#pragma once

#include "engine/core/types.h"

#include <vector>

namespace rend {

/// Velocity coefficients of the modes xy, yz, zx [1/(m s)] and xyz [1/(m2 s)], one column each.
using VelocityModes = Eigen::Matrix<Real, 3, 4>;

/// What a transfer scheme lets a particle hold beyond its velocity.
struct CarriedModes {
  bool affine = false;
  bool multilinear = false;
};

/// Arrays over #P particles; those of a feature that the scene leaves off stay empty.
struct Particles {
  std::vector<Vec3> x;                  ///< positions [m]
  std::vector<Vec3> v;                  ///< velocities [m/s]
  std::vector<Mat3> C;                  ///< affine velocity [1/s]; only for affine transfers
  std::vector<VelocityModes> modes;     ///< only for PolyPIC with 8 modes
  std::vector<Mat3> F;                  ///< elastic deformation gradient [-]
  std::vector<Vec3> force;              ///< of the mesh at its vertices [N]; only with mesh forces
  std::vector<Mat3> tau;                ///< Kirchhoff stress of F [Pa]
  std::vector<Real> tau_c;              ///< state of the material law, see material_response
  std::vector<Real> volume;             ///< rest volume [m3]
  std::vector<Real> mass;               ///< [kg]
  std::vector<std::uint16_t> material;  ///< index into SceneDesc::materials
  std::vector<std::uint8_t> yielded;    ///< 1 when it has ever yielded

  Index count() const { return static_cast<Index>(x.size()); }
};

}  // namespace rend
