// Kernels: partition of unity, linear completeness, constant inertia, derivatives.
#include "engine/core/random.h"
#include "engine/mpm/kernel.h"

#include <doctest/doctest.h>

using namespace rend;

template <class Kernel>
void check_kernel() {
  const Real dx = 0.3;
  Random random(1, 2);
  for (int n = 0; n < 2000; ++n) {
    Vec3 x(random.next(-5, 5), random.next(-5, 5), random.next(-5, 5));
    if (n < 20) x = dx * Vec3(n - 10, 0.5 * n, n + 0.5);  // on nodes and on edges
    const Stencil<Kernel> s(x, dx);
    for (int a = 0; a < 3; ++a) {
      Real one = 0, zero = 0, first = 0, second = 0, slope = 0;
      for (int i = 0; i < Kernel::kNodes; ++i) {
        CHECK(s.w[a][i] >= 0);
        CHECK(s.r[a][i] == doctest::Approx(dx * (s.base[a] + i) - x[a]).epsilon(1e-9));
        one += s.w[a][i];
        zero += s.dw[a][i];
        first += s.w[a][i] * s.r[a][i];
        second += s.w[a][i] * s.r[a][i] * s.r[a][i];
        slope += s.dw[a][i] * s.r[a][i];
      }
      CHECK(one == doctest::Approx(1).epsilon(1e-14));
      CHECK(std::abs(zero) < 1e-13);
      CHECK(std::abs(first) < 1e-13);
      CHECK(slope == doctest::Approx(1).epsilon(1e-12));
      CHECK(second == doctest::Approx(Kernel::kInertia * dx * dx).epsilon(1e-12));
      Vec3 ahead = x;
      const Real h = 1e-7;
      ahead[a] += h;
      const Stencil<Kernel> t(ahead, dx);
      if (t.base != s.base) continue;
      for (int i = 0; i < Kernel::kNodes; ++i)
        CHECK((t.w[a][i] - s.w[a][i]) / h == doctest::Approx(s.dw[a][i]).epsilon(1e-4));
    }
  }
}

TEST_CASE("quadratic B-spline") { check_kernel<QuadraticKernel>(); }
TEST_CASE("cubic B-spline") { check_kernel<CubicKernel>(); }
