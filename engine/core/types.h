// Scalars, small vectors and index types used everywhere.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace rend {

using Real = double;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec3f = Eigen::Vector3f;
using Vec3i = Eigen::Vector3i;
using Index = std::int32_t;

using Edge = std::array<Index, 2>;
using Triangle = std::array<Index, 3>;
using Tet = std::array<Index, 4>;  ///< positive volume: det(x1-x0, x2-x0, x3-x0) > 0

}  // namespace rend
