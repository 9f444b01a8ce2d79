// The spring of the pull tool.
#include "engine/mpm/pull.h"

#include <cmath>

namespace rend {

void advance_spring(PullForce& pull, const PulledMatter& matter, Real dt) {
  if (!pull.is_spring()) return;
  pull.force.setZero();
  const Real m = matter.mass, k = pull.stiffness;
  if (!(m > 0)) return;
  const Vec3 v = matter.momentum / m;
  // The matter has moved since the last step with the velocity it has now.
  pull.at += dt * v;
  const Real damping = 2 * std::sqrt(k * m);
  const Vec3 after =
      (matter.momentum + dt * k * (pull.target - pull.at)) / (m + dt * damping + dt * dt * k);
  pull.force = m / dt * (after - v);
  const Real size = pull.force.norm();
  if (size > pull.strongest) pull.force *= pull.strongest / size;
}

}  // namespace rend
