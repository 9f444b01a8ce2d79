// Yield surfaces against what each of them says of itself.
#include "engine/core/random.h"
#include "engine/material/law_constants.h"
#include "engine/material/material_desc.h"
#include "engine/material/material_law-inl.h"
#include "engine/material/material_point.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <string>

using namespace rend;

namespace {

MaterialDesc surface(const char* name, std::initializer_list<std::pair<const char*, Real>> values) {
  MaterialDesc m;
  m.youngs_modulus = 1;
  m.poisson_ratio = 0.3;
  m.yield_surface.type = find_yield_surface(name).value();
  const auto parameters = yield_surface_parameters(m.yield_surface.type);
  for (std::size_t i = 0; i < parameters.size(); ++i)
    m.yield_surface.value[i] = std::isnan(parameters[i].fallback) ? 0.05 : parameters[i].fallback;
  for (const auto& [key, value] : values)
    m.yield_surface.value[find_parameter(m.yield_surface.type, key).value()] = value;
  return m;
}

Triple<Real> random_strain(Random& random, Real size) {
  return {{size * random.next(-1, 1), size * random.next(-1, 1), size * random.next(-1, 1)}};
}

}  // namespace

TEST_CASE("the joint surface is Rankine where shear is free and von Mises where tension is") {
  Random random(2, 2);
  for (Real softening : {0.0, 0.2, -0.2}) {
    const auto tension = law_constants(
        surface("rankine_von_mises", {{"softening", softening}, {"shear_ratio", 1000}}));
    const auto rankine = law_constants(surface("rankine", {{"softening", softening}}));
    const auto shear =
        law_constants(surface("rankine_von_mises", {{"softening", softening}, {"shear_ratio", 1}}));
    const auto von_mises = law_constants(surface("von_mises", {{"softening", softening}}));
    int sheared = 0;
    for (int n = 0; n < 20000; ++n) {
      const Triple<Real> trial = random_strain(random, 0.3);
      // Under pressure only shear can fail.
      Triple<Real> pressed = trial;
      for (int i = 0; i < 3; ++i) pressed[i] -= 1;
      const auto under = RankineVonMises::return_map(shear, pressed, 0.05);
      const auto slip = VonMises::return_map(von_mises, pressed, 0.05);
      sheared += slip.yielded;
      REQUIRE(std::abs(under.tau_c - slip.tau_c) < 1e-13);
      for (int i = 0; i < 3; ++i) REQUIRE(std::abs(under.plastic[i] - slip.plastic[i]) < 1e-13);
      const auto joint = RankineVonMises::return_map(tension, trial, 0.05);
      const auto one = Rankine::return_map(rankine, trial, 0.05);
      // The shear bound shrinks with the threshold, to 0 in the end.
      if (one.tau_c < 1e-3) continue;
      REQUIRE(std::abs(joint.tau_c - one.tau_c) < 1e-13);
      for (int i = 0; i < 3; ++i) REQUIRE(std::abs(joint.plastic[i] - one.plastic[i]) < 1e-13);
    }
    CHECK(sheared > 5000);
  }
}

TEST_CASE("Drucker-Prager meets Mohr-Coulomb in triaxial compression and its tip in tension") {
  for (Real angle : {0.0, 20.0, 45.0}) {
    const auto k = law_constants(surface("drucker_prager", {{"friction_angle", angle}}));
    const Real phi = angle * std::numbers::pi / 180, c = 0.05;
    // tau_3 - tau_1 at yield under confinement tau_1 = tau_2 = -q: Mohr circle tangent to the line.
    for (Real q : {0.0, 0.1, 1.0}) {
      const Real sine = std::sin(phi);
      const Real axial = -(q * (1 + sine) + 2 * c * std::cos(phi)) / (1 - sine);
      // Principal strains of that stress.
      const Real sum = (axial - 2 * q) / (3 * k.lambda + k.mu2);
      const auto strain = [&](Real tau) { return (tau - k.lambda * sum) / k.mu2; };
      const Triple<Real> at{{strain(-q), strain(-q), strain(axial)}};
      CHECK(std::abs(DruckerPrager::value(k, at, c)) < 1e-13);
    }
    if (angle == 0) continue;
    const Real tip = c / std::tan(phi);
    const auto map = DruckerPrager::return_map(k, Triple<Real>{{0.9, 0.7, 0.8}}, c);
    Triple<Real> eps;
    for (int i = 0; i < 3; ++i) eps[i] = Triple<Real>{{0.9, 0.7, 0.8}}[i] - map.plastic[i];
    for (int i = 0; i < 3; ++i)
      CHECK(principal_stress(k.mu2, k.lambda, eps)[i] == doctest::Approx(tip).epsilon(1e-12));
  }
}

TEST_CASE("Drucker-Prager shears without a change of volume") {
  const auto k = law_constants(surface("drucker_prager", {{"softening", 0.05}}));
  Random random(4, 4);
  int sheared = 0;
  for (int n = 0; n < 20000; ++n) {
    Triple<Real> trial = random_strain(random, 0.3);
    for (int i = 0; i < 3; ++i) trial[i] -= 0.05;
    const auto map = DruckerPrager::return_map(k, trial, 0.05);
    if (!map.yielded || trace(trial) > 0) continue;
    ++sheared;
    REQUIRE(std::abs(trace(map.plastic)) < 1e-14);
  }
  CHECK(sheared > 1000);
}

TEST_CASE("cam clay hardens when crushed, softens when it dilates, and keeps its critical state") {
  const auto k = law_constants(
      surface("cam_clay", {{"preconsolidation", 0.05}, {"cohesion_ratio", 0.2}, {"hardening", 2}}));
  const Real bulk = k.lambda + k.mu2 / 3;
  const auto at_pressure = [&](Real p, Real shear) {
    const Real mean = -p / bulk / 3;
    return Triple<Real>{{mean + shear, mean, mean - shear}};
  };
  const auto crushed = CamClay::return_map(k, at_pressure(0.08, 0), 0.05);
  CHECK(crushed.yielded);
  // p0 = K sinh(asinh(p0/K) + xi compaction) with the compaction beyond the tip.
  const Real expected = bulk * std::sinh(std::asinh(0.05 / bulk) + 2 * (0.08 - 0.05) / bulk);
  CHECK(crushed.tau_c == doctest::Approx(expected).epsilon(1e-12));
  CHECK(CamClay::return_map(k, at_pressure(-0.02, 0), 0.05).tau_c < 0.05);
  CHECK_FALSE(CamClay::return_map(k, at_pressure(0.049, 0), 0.05).yielded);
  CHECK_FALSE(CamClay::return_map(k, at_pressure(-0.0099, 0), 0.05).yielded);
  // Sheared on the wet and dry side of the centre, and at it.
  const Real centre = 0.5 * (1 - 0.2) * 0.05;
  CHECK(CamClay::return_map(k, at_pressure(0.045, 0.3), 0.05).tau_c > 0.05);
  CHECK(CamClay::return_map(k, at_pressure(0.001, 0.3), 0.05).tau_c < 0.05);
  CHECK(CamClay::return_map(k, at_pressure(centre, 0.3), 0.05).tau_c ==
        doctest::Approx(0.05).epsilon(1e-12));
}

TEST_CASE("every surface turns with its matter") {
  Random random(5, 5);
  for (int type = 1; type < yield_surface_count(); ++type) {
    CAPTURE(std::string(yield_surface_name(type)));
    const MaterialDesc m = surface(std::string(yield_surface_name(type)).c_str(), {});
    const auto k = law_constants(m);
    const StressUpdate respond = stress_update(m);
    for (int n = 0; n < 200; ++n) {
      const auto next = [&] { return random.next(-1, 1); };
      Mat3 F = Mat3::Identity() + 0.3 * Mat3::NullaryExpr([&](auto, auto) { return next(); });
      const Mat3 R = Eigen::AngleAxisd(3 * next(), Vec3(next(), next(), next()).normalized())
                         .toRotationMatrix();
      Mat3 turned = R * F;
      Real a = 0.05, b = 0.05;
      const PointUpdate one = respond(k, F, a, 0.05), other = respond(k, turned, b, 0.05);
      REQUIRE((other.tau - R * one.tau * R.transpose()).norm() < 1e-12);
      REQUIRE((turned - R * F).norm() < 1e-11);
      REQUIRE(std::abs(a - b) < 1e-12);
    }
  }
}
