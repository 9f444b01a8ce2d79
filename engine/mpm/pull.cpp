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

Real work_of_pull(PullForce& pull, const PulledMatter& matter, Real dt) {
  if (!(matter.mass > 0)) {
    pull.acted = 0;
    return 0;
  }
  const Vec3 mean = matter.momentum / matter.mass;
  const Vec3 before = pull.acted > 0 ? pull.velocity : mean;
  pull.acted += dt;
  pull.velocity = mean + dt * matter.mass2 / (matter.mass * matter.mass) * pull.force;
  return 0.5 * dt * pull.force.dot(before + pull.velocity);
}

}  // namespace rend
