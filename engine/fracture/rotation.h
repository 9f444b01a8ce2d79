// Best-fitting rotations of particles over their neighbours: what "locally rigid" means.
#pragma once

#include "engine/core/types.h"

#include <Eigen/Geometry>

namespace rend {

/// The rotation R that maximises tr(R^T A), by Newton steps from `start`: with S = R^T A,
/// (tr(S) I - sym(S)) w = axial(S), R <- R exp(w). Follows one branch continuously, keeps det R = 1
/// and falls back to the global optimum (largest eigenvector of Horn's 4x4 matrix) where the start
/// is no good.
Eigen::Quaterniond fit_rotation(const Mat3& A, const Eigen::Quaterniond& start);

/// Moments of a neighbourhood, gathered with weights: A = sum w (x_b-x_a)(X_b-X_a)^T, and for a
/// small one, which may be a line, its rest counterpart.
struct ShapeMoments {
  Mat3 A = Mat3::Zero();
  Mat3 rest = Mat3::Zero();
  int count = 0;

  /// Two edges of a tet mesh leave a particle along a line, slivers make it a few more.
  static bool may_be_line(std::size_t neighbours) { return neighbours <= 4; }

  void add(const Vec3& x_ab, const Vec3& X_ab, Real weight) {
    A.noalias() += x_ab * (weight * X_ab).transpose();
    ++count;
  }
  void add_rest(const Vec3& X_ab, Real weight) {
    rest.noalias() += X_ab * (weight * X_ab).transpose();
  }
  void add(const ShapeMoments& other) {
    A += other.A;
    rest += other.rest;
    count += other.count;
  }
  /// Neighbours on a line say nothing about the turn about that line. False where rest moments were
  /// not gathered.
  bool on_line() const;
  /// No neighbour: `start`. Neighbours on a line: `start`, turned by the shortest arc. Else the
  /// fit.
  Eigen::Quaterniond rotation(const Eigen::Quaterniond& start) const;
};

}  // namespace rend
