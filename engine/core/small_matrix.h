// Functions of 3x3 matrices: symmetric eigen-decomposition and exponential.
#pragma once

#include "engine/core/types.h"

namespace rend {

/// A = U diag(value) U^T, in no particular order; U is a rotation up to round-off.
struct SymmetricEigen {
  Vec3 value;
  Mat3 U;
};

/// Cyclic Jacobi; the error of every eigenvalue is a few ulp of |A|, so that A = b - 1 keeps tiny
/// strains exact. Ends after a fixed number of sweeps, also for NaN. About 0.2 us.
SymmetricEigen symmetric_eigen(const Mat3& A);

/// Matrix exponential by scaling and squaring of the Taylor series; det exp(A) = e^{tr A} > 0.
Mat3 matrix_exponential(const Mat3& A);

}  // namespace rend
