// Newton on the rotation group: quadratic convergence makes rigid motion exact to round-off in a
// few steps.
#include "engine/fracture/rotation.h"

#include <Eigen/Eigenvalues>

namespace rend {

namespace {

Eigen::Quaterniond best_rotation(const Mat3& A) {
  // Horn 1987: tr(R^T A) = q^T N q.
  Eigen::Matrix4d N;
  const Vec3 axial(A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1));
  N(0, 0) = A.trace();
  N.block<3, 1>(1, 0) = axial;
  N.block<1, 3>(0, 1) = axial.transpose();
  N.block<3, 3>(1, 1) = A + A.transpose() - A.trace() * Mat3::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(N);
  const Eigen::Vector4d q = solver.eigenvectors().col(3);
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

}  // namespace

Eigen::Quaterniond fit_rotation(const Mat3& A, const Eigen::Quaterniond& start) {
  const Real scale = A.norm();
  if (!(scale > 0) || !std::isfinite(scale)) return start;
  Eigen::Quaterniond q = start;
  bool searched = false;
  for (int step = 0; step < 20; ++step) {
    const Mat3 S = q.toRotationMatrix().transpose() * A;
    const Vec3 axial(S(2, 1) - S(1, 2), S(0, 2) - S(2, 0), S(1, 0) - S(0, 1));
    Mat3 H = -0.5 * (S + S.transpose());
    H.diagonal().array() += S.trace();
    // Positive definite (leading minors), or this is no maximum to walk to.
    const Real minor = H(0, 0) * H(1, 1) - H(0, 1) * H(1, 0);
    const Real det = H.determinant();
    const bool hill =
        H(0, 0) > 0 && minor > 1e-9 * scale * scale && det > 1e-9 * scale * scale * scale;
    Vec3 w = Vec3::Constant(10);
    if (hill) {
      w.x() = axial.dot(H.col(1).cross(H.col(2)));
      w.y() = axial.dot(H.col(2).cross(H.col(0)));
      w.z() = axial.dot(H.col(0).cross(H.col(1)));
      w /= det;
    }
    const Real angle2 = w.squaredNorm();
    if (angle2 > 1.5) {
      if (searched) return q;
      q = best_rotation(A);
      searched = true;
      continue;
    }
    // Quadratic: the error after this step is about angle^2.
    q = (q * Eigen::Quaterniond(1, 0.5 * w.x(), 0.5 * w.y(), 0.5 * w.z())).normalized();
    if (angle2 < 1e-17) return q;
  }
  return q;
}

bool ShapeMoments::on_line() const {
  // Sum of the principal minors over the trace: depends on rest positions only, so there is no jump
  // while the neighbours stay the same.
  const Real trace = rest.trace();
  return trace > 0 && 0.5 * (trace * trace - rest.squaredNorm()) <= 1e-3 * trace * trace;
}

Eigen::Quaterniond ShapeMoments::rotation(const Eigen::Quaterniond& start) const {
  if (count == 0) return start;
  if (!on_line()) return fit_rotation(A, start);
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(rest);
  const Vec3 rest_axis = axes.eigenvectors().col(2);
  const Vec3 axis = A * rest_axis;
  if (!(axis.squaredNorm() > 0)) return start;
  return (Eigen::Quaterniond::FromTwoVectors(start * rest_axis, axis) * start).normalized();
}

}  // namespace rend
