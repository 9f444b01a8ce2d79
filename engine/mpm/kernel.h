// Tensor-product B-spline kernels between particles and grid nodes.
#pragma once

#include "engine/core/types.h"

#include <cmath>

namespace rend {

/// Quadratic B-spline, C1, support of 3 nodes; D = sum w r r^T = dx^2/4 1.
struct QuadraticKernel {
  static constexpr int kNodes = 3;
  static constexpr Real kInertia = 0.25;  ///< D / dx^2
  /// First node of the support of a coordinate x in cells.
  static Real base(Real x) { return std::floor(x - 0.5); }
  /// Weights and their derivatives with respect to x in cells, for f = x - base in [0.5, 1.5).
  static void weights(Real f, Real* w, Real* dw) {
    w[0] = 0.5 * (1.5 - f) * (1.5 - f);
    w[1] = 0.75 - (f - 1) * (f - 1);
    w[2] = 0.5 * (f - 0.5) * (f - 0.5);
    dw[0] = f - 1.5;
    dw[1] = -2 * (f - 1);
    dw[2] = f - 0.5;
  }
};

/// Cubic B-spline, C2, support of 4 nodes; D = dx^2/3 1.
struct CubicKernel {
  static constexpr int kNodes = 4;
  static constexpr Real kInertia = 1.0 / 3;
  static Real base(Real x) { return std::floor(x) - 1; }
  /// f = x - base in [1, 2).
  static void weights(Real f, Real* w, Real* dw) {
    const Real a = f - 1, b = 2 - f;
    w[0] = b * b * b / 6;
    w[1] = (0.5 * a - 1) * a * a + 2.0 / 3;
    w[2] = (0.5 * b - 1) * b * b + 2.0 / 3;
    w[3] = a * a * a / 6;
    dw[0] = -0.5 * b * b;
    dw[1] = (1.5 * a - 2) * a;
    dw[2] = -(1.5 * b - 2) * b;
    dw[3] = 0.5 * a * a;
  }
};

/// Support of one particle: per axis the weights, derivatives and offsets x_i - x_p of its nodes.
template <class Kernel>
struct Stencil {
  static constexpr int kNodes = Kernel::kNodes;
  Vec3i base;          ///< first node, in cells from the world origin
  Real w[3][kNodes];   ///< [-]
  Real dw[3][kNodes];  ///< d w / d x_p [1/m]
  Real r[3][kNodes];   ///< x_i - x_p [m]

  Stencil(const Vec3& x, Real dx) {
    for (int a = 0; a < 3; ++a) {
      const Real cells = x[a] / dx, first = Kernel::base(cells), f = cells - first;
      base[a] = static_cast<int>(first);
      Kernel::weights(f, w[a], dw[a]);
      for (int n = 0; n < kNodes; ++n) {
        dw[a][n] /= dx;
        r[a][n] = (n - f) * dx;
      }
    }
  }
};

}  // namespace rend
