// Material points driven along paths with closed-form answers; softening is implicit, so that the
// number of steps does not matter.
#include "engine/core/error.h"
#include "engine/material/material_point.h"
#include "engine/scene/scene_desc.h"

#include <doctest/doctest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <functional>

using namespace rend;

namespace {

constexpr Real kE = 2e5, kNu = 0.3, kTauC = 3e3, kAlpha = 4e4;

MaterialDesc softening(const char* surface, Real alpha = kAlpha) {
  MaterialDesc m;
  m.youngs_modulus = kE;
  m.poisson_ratio = kNu;
  m.yield_surface.type = find_yield_surface(surface).value();
  m.yield_surface.value[0] = kTauC;
  m.yield_surface.value[1] = alpha;
  return m;
}

const Lame kLame = lame_parameters(kE, kNu);
const Real kM = kLame.lambda + 2 * kLame.mu;
const Real k3K = 3 * kLame.lambda + 2 * kLame.mu;

std::vector<ProbeRow> drive(const MaterialDesc& m, Real end, int steps,
                            const std::function<Mat3(Real)>& F) {
  std::vector<Mat3> path;
  for (int n = 1; n <= steps; ++n) path.push_back(F(end * n / steps));
  return probe(m, path);
}

Mat3 diagonal(Real a, Real b, Real c) {
  return Vec3(std::exp(a), std::exp(b), std::exp(c)).asDiagonal();
}

}  // namespace

TEST_CASE("Rankine in uniaxial strain") {
  const auto F = [](Real s) { return diagonal(s, 0, 0); };
  const Real yield = kTauC / kM, slope = -kAlpha * kM / (kM - kAlpha);
  for (int steps : {1, 7, 500}) {
    CAPTURE(steps);
    // Before yield, half-way down, and with the strength used up.
    auto row = drive(softening("rankine"), 0.9 * yield, steps, F).back();
    CHECK(row.tau(0, 0) == doctest::Approx(0.9 * kTauC).epsilon(1e-12));
    CHECK_FALSE(row.yielded);
    const Real s = 2 * yield;
    row = drive(softening("rankine"), s, steps, F).back();
    const Real tau = kTauC + slope * (s - yield);
    CHECK(row.tau(0, 0) == doctest::Approx(tau).epsilon(1e-12));
    CHECK(row.tau_c == doctest::Approx(tau).epsilon(1e-12));
    CHECK(row.dissipation ==
          doctest::Approx((kTauC * kTauC - tau * tau) / (2 * kAlpha)).epsilon(1e-11));
    row = drive(softening("rankine"), kTauC / kAlpha * 1.5, steps, F).back();
    CHECK(row.tau_c == 0);
    CHECK(std::abs(row.tau(0, 0)) < 1e-9);
    CHECK(row.dissipation == doctest::Approx(kTauC * kTauC / (2 * kAlpha)).epsilon(1e-11));
  }
}

TEST_CASE("Rankine under hydrostatic tension reaches the apex and loses strength there") {
  const auto F = [](Real s) { return diagonal(s, s, s); };
  const Real yield = kTauC / k3K, slope = -kAlpha * k3K / (k3K - kAlpha);
  for (int steps : {1, 9, 300}) {
    const Real s = 1.7 * yield;
    auto row = drive(softening("rankine"), s, steps, F).back();
    const Real tau = kTauC + slope * (s - yield);
    CHECK((row.tau - tau * Mat3::Identity()).norm() < 1e-11 * kTauC);
    row = drive(softening("rankine"), kTauC / kAlpha * 2, steps, F).back();
    CHECK(row.dissipation == doctest::Approx(3 * kTauC * kTauC / (2 * kAlpha)).epsilon(1e-11));
  }
}

TEST_CASE("Rankine in uniaxial stress") {
  // The lateral strain is solved so that the lateral stress stays 0; only one principal stress is
  // active.
  const Real yield = kTauC / kE, slope = -kAlpha * kE / (kE - kAlpha);
  for (int steps : {2, 50}) {
    std::vector<Mat3> path;
    const Real end = 2.5 * yield;
    ProbeRow row;
    for (int n = 1; n <= steps; ++n) {
      const Real s = end * n / steps;
      Real low = -s, high = 0;
      for (int i = 0; i < 100; ++i) {
        const Real lateral = 0.5 * (low + high);
        auto trial = path;
        trial.push_back(diagonal(s, lateral, lateral));
        row = probe(softening("rankine"), trial).back();
        (row.tau(1, 1) > 0 ? high : low) = lateral;
      }
      path.push_back(diagonal(s, low, low));
    }
    CHECK(row.tau(0, 0) == doctest::Approx(kTauC + slope * (end - yield)).epsilon(1e-11));
  }
}

TEST_CASE("von Mises in pure shear") {
  const auto F = [](Real s) { return diagonal(s, -s, 0); };
  const Real yield = kTauC / (2 * std::sqrt(2.0) * kLame.mu);
  const Real slope = -2 * kLame.mu * kAlpha / (2 * kLame.mu - kAlpha);
  for (int steps : {1, 8, 400}) {
    const Real s = 2 * yield;
    auto row = drive(softening("von_mises"), s, steps, F).back();
    const Real norm = kTauC + slope * std::sqrt(2.0) * (s - yield);
    CHECK(row.tau.norm() == doctest::Approx(norm).epsilon(1e-12));
    CHECK(std::abs(row.tau.trace()) < 1e-10 * kTauC);
    row = drive(softening("von_mises"), kTauC / kAlpha * 2, steps, F).back();
    CHECK(row.tau_c == 0);
    CHECK(row.dissipation == doctest::Approx(kTauC * kTauC / (2 * kAlpha)).epsilon(1e-11));
  }
}

TEST_CASE("the slides' explicit rule lags: it depends on the number of steps") {
  MaterialDesc m = softening("rankine");
  m.softening_rule = SofteningRule::explicit_rule;
  const auto F = [](Real s) { return diagonal(s, 0, 0); };
  const Real yield = kTauC / kM, s = 2 * yield;
  const Real exact = kTauC - kAlpha * kM / (kM - kAlpha) * (s - yield);
  const Real coarse = drive(m, s, 10, F).back().tau_c - exact;
  const Real fine = drive(m, s, 1000, F).back().tau_c - exact;
  CHECK(std::abs(coarse) > 1e-4 * kTauC);
  CHECK(std::abs(fine) < 0.02 * std::abs(coarse));
  // One step projects on the old threshold, then shrinks it by alpha times the plastic strain.
  const ProbeRow one = drive(m, s, 1, F).back();
  CHECK(one.tau(0, 0) == doctest::Approx(kTauC).epsilon(1e-12));
  CHECK(one.tau_c == doctest::Approx(kTauC - kAlpha * (s - yield)).epsilon(1e-12));
}

TEST_CASE("stress turns with the body, and a turned path dissipates the same") {
  const Mat3 R = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  Mat3 F;
  F << 1.2, 0.3, 0, -0.1, 0.9, 0.2, 0.05, 0, 1.1;
  for (const char* surface : {"elastic", "rankine", "von_mises"}) {
    MaterialDesc m = softening(surface);
    const std::vector<Mat3> path{0.5 * (F + Mat3::Identity()), F};
    const std::vector<Mat3> turned{R * path[0], R * path[1]};
    const auto a = probe(m, path), b = probe(m, turned);
    CHECK((b[1].tau - R * a[1].tau * R.transpose()).norm() < 1e-12 * k3K);
    CHECK(std::abs(b[1].dissipation - a[1].dissipation) < 1e-12 * kTauC);
    CHECK(std::abs(b[1].tau_c - a[1].tau_c) < 1e-11 * kTauC);
  }
}

TEST_CASE("unloading is elastic and reloading meets the same threshold") {
  const Real yield = kTauC / kM;
  const std::vector<Mat3> path{diagonal(1.5 * yield, 0, 0), diagonal(1.3 * yield, 0, 0),
                               diagonal(1.5 * yield, 0, 0)};
  const auto row = probe(softening("rankine"), path);
  CHECK(row[0].tau(0, 0) - row[1].tau(0, 0) == doctest::Approx(kM * 0.2 * yield).epsilon(1e-11));
  CHECK_FALSE(row[1].yielded);
  CHECK(row[2].tau(0, 0) == doctest::Approx(row[0].tau(0, 0)).epsilon(1e-12));
  CHECK(std::abs(row[2].dissipation - row[0].dissipation) < 1e-12 * row[0].dissipation);
}

TEST_CASE("stress is the derivative of the energy, tau = dpsi/dF F^T") {
  const LawConstants<Real> k = law_constants(softening("elastic"));
  const StressUpdate respond = stress_update(softening("elastic"));
  Mat3 F;
  F << 1.2, 0.3, 0, -0.1, 0.9, 0.2, 0.05, 0, 0.8;
  Mat3 P;
  const Real h = 1e-5;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Mat3 plus = F, minus = F;
      plus(i, j) += h;
      minus(i, j) -= h;
      P(i, j) = (elastic_energy_density(k, plus, false) - elastic_energy_density(k, minus, false)) /
                (2 * h);
    }
  Mat3 copy = F;
  Real tau_c = 1;
  const Mat3 tau = respond(k, copy, tau_c, 1).tau;
  CHECK((P * F.transpose() - tau).norm() < 1e-8 * tau.norm());
  CHECK(copy == F);
}

TEST_CASE("tiny strains keep their relative accuracy") {
  for (Real s : {1e-6, 1e-9, 1e-12}) {
    const std::vector<Mat3> path{diagonal(s, 0, 0)};
    const Real strain = std::log1p(path[0](0, 0) - 1);
    CHECK(probe(softening("elastic"), path)[0].tau(0, 0) ==
          doctest::Approx(kM * strain).epsilon(1e-12));
  }
}

TEST_CASE("flat and inverted deformation gradients give a finite stress that pushes outwards") {
  const LawConstants<Real> k = law_constants(softening("elastic"));
  const StressUpdate respond = stress_update(softening("elastic"));
  for (Real flat : {1e-2, 1e-6, 0.0, -1e-3, -1.0}) {
    Mat3 F = Vec3(1.1, 1, flat).asDiagonal();
    Real tau_c = 1;
    const PointUpdate u = respond(k, F, tau_c, 1);
    CHECK(u.clamped);
    CHECK(u.tau.allFinite());
    CHECK(u.tau(2, 2) < 0);
    CHECK(F.determinant() >= 0.9 * kSmallestStretch);
  }
  Mat3 F = Vec3(1000, 1, 1).asDiagonal();
  Real tau_c = 1;
  const PointUpdate u = respond(k, F, tau_c, 1);
  CHECK_FALSE(u.clamped);
  CHECK(u.tau(0, 0) == doctest::Approx(kM * std::log(1000)).epsilon(1e-10));
}

TEST_CASE(
    "granular damage: no tension, pressure kept, gained volume used up before it pushes back") {
  MaterialDesc m = softening("rankine");
  m.damage.type = DamageType::granular;
  m.damage.threshold = 0.1;
  const Real pull = kTauC / kAlpha * 1.2;
  // Damaged at `pull`; opened by 0.2, half closed, closed, pressed, opened.
  const std::vector<Mat3> path{
      diagonal(pull, 0, 0), diagonal(pull + 0.2, 0, 0),          diagonal(pull + 0.1, 0, 0),
      diagonal(pull, 0, 0), diagonal(pull - 0.02, -0.02, -0.02), diagonal(pull - 0.02, -0.02, 0.2)};
  const auto row = probe(m, path);
  CHECK(row[0].tau_c == 0);
  CHECK(row[0].tau.norm() == 0);
  CHECK(row[1].tau.norm() == 0);
  CHECK(row[2].tau.norm() == 0);
  // Closed, nothing presses yet; beyond that the bulk modulus is whole.
  CHECK(row[3].tau.norm() < 1e-9 * kTauC);
  const Real mu = m.damage.shear_factor * kLame.mu;
  CHECK(row[4].tau(0, 0) == doctest::Approx(-0.02 * (3 * kLame.lambda + 2 * mu)).epsilon(1e-9));
  CHECK(row[5].tau.norm() == 0);
  for (std::size_t i = 1; i < row.size(); ++i) CHECK(row[i].dissipation >= row[i - 1].dissipation);
  // Damage lets go the elastic energy that was left: nothing is created.
  CHECK(row[0].dissipation >= kTauC * kTauC / (2 * kAlpha) * (1 - 0.01));
}

TEST_CASE("granular damage shears with friction only") {
  MaterialDesc m = softening("rankine");
  m.damage.type = DamageType::granular;
  m.damage.threshold = 0.1;
  const std::vector<Mat3> path{diagonal(kTauC / kAlpha * 1.2, 0, 0), diagonal(0, 0, 0),
                               diagonal(1.0, -0.6, -0.6)};
  const Mat3 tau = probe(m, path).back().tau;
  const Real pressure = -tau.trace() / 3;
  const Real sine = std::sin(30 * 3.14159265358979 / 180);
  CHECK(pressure > 0);
  const Mat3 dev = tau + pressure * Mat3::Identity();
  CHECK(dev.norm() ==
        doctest::Approx(std::sqrt(2.0 / 3) * 6 * sine / (3 - sine) * pressure).epsilon(1e-9));
}

TEST_CASE("damage 'zero' carries nothing, and damage 'off' still carries pressure") {
  const std::vector<Mat3> path{diagonal(kTauC / kAlpha * 1.2, 0, 0), diagonal(-0.1, -0.1, -0.1)};
  MaterialDesc m = softening("rankine");
  m.damage.type = DamageType::zero;
  CHECK(probe(m, path).back().tau.norm() == 0);
  m.damage.type = DamageType::off;
  CHECK(probe(m, path).back().tau.trace() < -0.1 * k3K);
}

TEST_CASE("a path that turns matter inside out is refused with its row") {
  const std::vector<Mat3> path{Mat3::Identity(), Vec3(1, 1, -1).asDiagonal()};
  CHECK_THROWS_WITH_AS(probe(softening("elastic"), path), doctest::Contains("row 2"), Error);
}
