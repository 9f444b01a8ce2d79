// Spectral decomposition around the principal-strain laws.
#include "engine/material/material_point.h"

#include "engine/core/error.h"
#include "engine/core/small_matrix.h"
#include "engine/material/material_law-inl.h"
#include "engine/material/material_desc.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <string>

namespace rend {

namespace {

// Left stretch of F: principal Hencky strains and directions.
struct LeftStretch {
  Triple<Real> eps;
  Mat3 U;
};

// b - 1 is formed from F - 1, so that strains far below 1e-8 are not lost in the round-off of b.
SymmetricEigen left_stretch_squared_minus_one(const Mat3& F) {
  const Mat3 H = F - Mat3::Identity();
  return symmetric_eigen(H + H.transpose() + H * H.transpose());
}

// F with its stretches raised to kSmallestStretch; an inverted F is turned out along its thinnest
// direction.
Mat3 raise_stretches(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU(), V = svd.matrixV();
  Vec3 stretch = svd.singularValues();
  if (U.determinant() < 0) {
    U.col(2) = -U.col(2);
    stretch[2] = -stretch[2];
  }
  if (V.determinant() < 0) {
    V.col(2) = -V.col(2);
    stretch[2] = -stretch[2];
  }
  return U * stretch.cwiseMax(kSmallestStretch).asDiagonal() * V.transpose();
}

LeftStretch left_stretch(Mat3& F, bool& clamped) {
  SymmetricEigen e = left_stretch_squared_minus_one(F);
  const Real smallest = kSmallestStretch * kSmallestStretch - 1;
  clamped = F.determinant() <= 0 || e.value.minCoeff() < smallest;
  if (clamped && F.allFinite()) {
    F = raise_stretches(F);
    e = left_stretch_squared_minus_one(F);
  }
  LeftStretch out{{}, e.U};
  for (int i = 0; i < 3; ++i) out.eps[i] = 0.5 * std::log1p(std::max(e.value[i], smallest));
  return out;
}

Mat3 from_principal(const Mat3& U, const Triple<Real>& value) {
  return U * Vec3(value[0], value[1], value[2]).asDiagonal() * U.transpose();
}

template <class Law, class Damage>
PointUpdate update(const LawConstants<Real>& k, Mat3& F, Real& tau_c, Real tau_c0) {
  PointUpdate out;
  const LeftStretch trial = left_stretch(F, out.clamped);
  const MaterialResponse<Real> response =
      material_response<Law, Damage>(k, trial.eps, tau_c, tau_c0);
  if (response.change[0] != 0 || response.change[1] != 0 || response.change[2] != 0) {
    const Triple<Real> factor{
        {std::exp(response.change[0]), std::exp(response.change[1]), std::exp(response.change[2])}};
    F = from_principal(trial.U, factor) * F;
  }
  tau_c = response.tau_c;
  out.tau = from_principal(trial.U, response.stress);
  out.least_stress = std::min({response.stress[0], response.stress[1], response.stress[2]});
  out.dissipation = response.dissipation;
  out.yielded = response.yielded;
  out.damaged = response.damaged;
  return out;
}

}  // namespace

StressUpdate stress_update(const MaterialDesc& material) {
  StressUpdate chosen = nullptr;
  with_material_law(
      material.yield_surface.type, static_cast<int>(material.damage.type),
      [&](auto law, auto damage) { chosen = update<decltype(law), decltype(damage)>; });
  return chosen;
}

Real elastic_energy_density(const LawConstants<Real>& k, const Mat3& F, bool damaged) {
  Mat3 copy = F;
  bool clamped;
  const LeftStretch stretch = left_stretch(copy, clamped);
  return energy_density(damaged ? k.damage_mu2 : k.mu2, k.lambda, stretch.eps);
}

std::vector<ProbeRow> probe(const MaterialDesc& material, std::span<const Mat3> path) {
  const LawConstants<Real> k = law_constants(material);
  const StressUpdate respond = stress_update(material);
  const Real tau_c0 = initial_threshold(material.yield_surface);
  Real tau_c = tau_c0, dissipation = 0;
  Mat3 elastic = Mat3::Identity(), before = Mat3::Identity();
  std::vector<ProbeRow> rows;
  for (const Mat3& F : path) {
    if (!F.allFinite() || F.determinant() <= 0)
      throw Error("row " + std::to_string(rows.size() + 1), "F has determinant " +
                                                                std::to_string(F.determinant()) +
                                                                "; it must be finite and positive");
    elastic = F * before.inverse() * elastic;
    before = F;
    const PointUpdate step = respond(k, elastic, tau_c, tau_c0);
    dissipation += step.dissipation;
    rows.push_back({step.tau, std::max(tau_c, 0.0), step.yielded, dissipation});
  }
  return rows;
}

}  // namespace rend
