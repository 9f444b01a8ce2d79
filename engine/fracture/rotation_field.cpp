// Every particle writes its own slot only, so threads do not change a bit.
#include "engine/fracture/rotation_field.h"

#include "engine/core/parallel.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rend {

namespace {

constexpr Index grain = 512;
constexpr Real misfit_scale = 0.2;  // of the mean edge length
constexpr int affine_rounds = 4;
constexpr Real affine_anchor = 1e-2;  // pull towards the rotation, of the trace of the moments

Eigen::Quaterniond robust_rotation(Index p, std::span<const Vec3> x, const CrackMesh& crack,
                                   Eigen::Quaterniond q, bool warm) {
  const TetTables& tables = crack.tables();
  const Real scale = misfit_scale * tables.mean_edge[tables.body[p]];
  const bool few = ShapeMoments::may_be_line(crack.linked(p).size());
  for (int round = 0; round < 4; ++round) {
    ShapeMoments moments;
    Real largest = 0;
    const Mat3 R = q.toRotationMatrix();
    for (Index b : crack.linked(p)) {
      const Vec3 X_ab = tables.X[b] - tables.X[p], x_ab = x[b] - x[p];
      // Without a rotation to trust, the change of length is all there is to tell a stranger by.
      const bool trusted = round > 0 || warm;
      const Real misfit2 =
          trusted ? (x_ab - R * X_ab).squaredNorm() : std::pow(x_ab.norm() - X_ab.norm(), 2);
      if (trusted) largest = std::max(largest, misfit2);
      const Real weight = 1 / (X_ab.squaredNorm() * (1 + misfit2 / (scale * scale)));
      moments.add(x_ab, X_ab, weight);
      if (few) moments.add_rest(X_ab, weight);
    }
    q = moments.rotation(q);
    // All neighbours come along: another round would weigh them the same.
    if (largest > 0 && largest < scale * scale) break;
  }
  return q;
}

}  // namespace

void RotationField::set(Index p, const Eigen::Quaterniond& q) {
  reserve({&p, 1});
  rotation_[slot_[p]] = q;
}

void RotationField::reserve(std::span<const Index> particles) {
  for (Index p : particles)
    if (slot_[p] < 0) {
      slot_[p] = static_cast<Index>(rotation_.size());
      rotation_.push_back(Eigen::Quaterniond::Identity());
    }
}

void RotationField::fit(std::span<const Index> particles, std::span<const Vec3> x,
                        const CrackMesh& crack) {
  reserve(particles);
  const std::vector<Vec3>& X = crack.tables().X;
  const auto moments_of = [&](Index p, bool few) {
    ShapeMoments moments;
    for (Index b : crack.linked(p)) {
      const Vec3 X_ab = X[b] - X[p];
      const Real weight = 1 / X_ab.squaredNorm();
      moments.add(x[b] - x[p], X_ab, weight);
      if (few) moments.add_rest(X_ab, weight);
    }
    return moments;
  };
  parallel_for(static_cast<Index>(particles.size()), grain, [&](Index i) {
    const Index p = particles[i];
    ShapeMoments moments = moments_of(p, ShapeMoments::may_be_line(crack.linked(p).size()));
    // Hanging on a thread, a particle turns with what it hangs on.
    if (moments.on_line())
      for (Index b : crack.linked(p)) moments.add(moments_of(b, true));
    Eigen::Quaterniond& q = rotation_[slot_[p]];
    q = moments.rotation(q);
  });
}

void RotationField::fit_robust(std::span<const Index> particles, std::span<const Vec3> x,
                               const CrackMesh& crack) {
  std::vector<std::uint8_t> warm(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) warm[i] = known(particles[i]);
  reserve(particles);
  parallel_for(static_cast<Index>(particles.size()), grain, [&](Index i) {
    Eigen::Quaterniond& q = rotation_[slot_[particles[i]]];
    q = robust_rotation(particles[i], x, crack, q, warm[i] != 0);
  });
}

Mat3 fit_affine_robust(Index p, std::span<const Vec3> x, const CrackMesh& crack,
                       const Mat3& rotation) {
  const TetTables& tables = crack.tables();
  const std::span<const Index> linked = crack.linked(p);
  if (linked.empty()) return rotation;
  const Real finest = misfit_scale * tables.mean_edge[tables.body[p]];
  const auto misfit2 = [&](const Mat3& F, Index b) {
    return (x[b] - x[p] - F * (tables.X[b] - tables.X[p])).squaredNorm();
  };
  std::vector<Real> sorted(linked.size());
  Mat3 F = rotation;
  for (int round = 0; round < affine_rounds; ++round) {
    // In a flow all are strangers to the rotation: the nearest quarter sets the scale.
    for (std::size_t i = 0; i < linked.size(); ++i) sorted[i] = misfit2(F, linked[i]);
    const auto quarter = sorted.begin() + static_cast<std::ptrdiff_t>(linked.size() / 4);
    std::nth_element(sorted.begin(), quarter, sorted.end());
    const Real scale2 = std::max(finest * finest, *quarter);
    ShapeMoments moments;
    for (Index b : linked) {
      const Vec3 X_ab = tables.X[b] - tables.X[p];
      const Real weight = 1 / (X_ab.squaredNorm() * (1 + misfit2(F, b) / scale2));
      moments.add(x[b] - x[p], X_ab, weight);
      moments.add_rest(X_ab, weight);
    }
    const Mat3 anchored = moments.rest + affine_anchor * moments.rest.trace() * Mat3::Identity();
    F = rotation + (moments.A - rotation * moments.rest) * anchored.inverse();
  }
  return F;
}

}  // namespace rend
