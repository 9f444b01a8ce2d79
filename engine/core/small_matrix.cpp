// Jacobi rotations and the matrix exponential for 3x3 matrices.
#include "engine/core/small_matrix.h"

#include <cmath>

namespace rend {

namespace {

// One Jacobi rotation in the plane (p, q) that makes a(p, q) zero; r is the third index.
template <int p, int q, int r>
void rotate(Mat3& a, Mat3& U) {
  if (a(p, q) == 0) return;
  const Real theta = (a(q, q) - a(p, p)) / (2 * a(p, q));
  const Real t = (theta >= 0 ? 1 : -1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
  const Real c = 1 / std::sqrt(t * t + 1), s = t * c;
  a(p, p) -= t * a(p, q);
  a(q, q) += t * a(p, q);
  a(p, q) = 0;
  const Real rp = c * a(r, p) - s * a(r, q);
  a(r, q) = s * a(r, p) + c * a(r, q);
  a(r, p) = rp;
  a(p, r) = rp;
  a(q, r) = a(r, q);
  a(q, p) = 0;
  const Vec3 up = U.col(p);
  U.col(p) = c * up - s * U.col(q);
  U.col(q) = s * up + c * U.col(q);
}

}  // namespace

SymmetricEigen symmetric_eigen(const Mat3& A) {
  Mat3 a = A;
  Mat3 U = Mat3::Identity();
  for (int sweep = 0; sweep < 12; ++sweep) {
    const Real off = std::fabs(a(0, 1)) + std::fabs(a(0, 2)) + std::fabs(a(1, 2));
    const Real diagonal = std::fabs(a(0, 0)) + std::fabs(a(1, 1)) + std::fabs(a(2, 2));
    if (!(off > 1e-16 * diagonal)) break;
    rotate<0, 1, 2>(a, U);
    rotate<0, 2, 1>(a, U);
    rotate<1, 2, 0>(a, U);
  }
  return {a.diagonal(), U};
}

Mat3 matrix_exponential(const Mat3& A) {
  const Real size = A.cwiseAbs().maxCoeff();
  if (!(size < 1e3)) return Mat3::Constant(std::nan(""));
  int halvings = 0;
  for (Real s = size; s > 0.1; s *= 0.5) ++halvings;
  const Mat3 a = std::ldexp(1.0, -halvings) * A;
  Mat3 sum = Mat3::Identity() + a;
  Mat3 term = a;
  for (int n = 2; n < 16; ++n) {
    term = (term * a).eval() / n;
    sum += term;
    if (term.cwiseAbs().maxCoeff() < 1e-18) break;
  }
  for (int n = 0; n < halvings; ++n) sum = (sum * sum).eval();
  return sum;
}

}  // namespace rend
