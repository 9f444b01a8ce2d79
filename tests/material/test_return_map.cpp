// Properties that every listed yield surface must have; a new surface is tested by being listed.
#include "engine/core/random.h"
#include "engine/material/law_constants.h"
#include "engine/material/material_law-inl.h"
#include "engine/scene/scene_desc.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

using namespace rend;

namespace {

MaterialDesc material(int type, Real poisson_ratio, Real tau_c, Real softening) {
  MaterialDesc m;
  m.youngs_modulus = 1;
  m.poisson_ratio = poisson_ratio;
  m.yield_surface.type = type;
  const auto set = [&](std::string_view name, Real value) {
    if (const auto i = find_parameter(type, name)) m.yield_surface.value[*i] = value;
  };
  const auto parameters = yield_surface_parameters(type);
  for (std::size_t i = 0; i < parameters.size(); ++i)
    m.yield_surface.value[i] = parameters[i].fallback;
  set("tau_c", tau_c);
  set("softening", softening);
  return m;
}

// Random strains with equal, nearly equal, tiny and huge principal values mixed in.
template <class S>
Triple<S> random_strain(Random& random) {
  const Real scale = std::pow(10.0, random.next(-4, 0.7));
  Triple<S> e;
  for (int i = 0; i < 3; ++i) e[i] = S(scale * random.next(-1, 1));
  const Real kind = random.next();
  if (kind < 0.1) e[1] = e[0];
  if (kind < 0.05) e[2] = e[0];
  if (kind > 0.9) e[2] = e[1] * (S(1) + S(1e-7));
  if (kind > 0.5 && kind < 0.52) e = {{S(0), S(0), S(0)}};
  return e;
}

template <class S>
void check_properties(S tolerance) {
  for (int type = 0; type < yield_surface_count(); ++type)
    for (Real poisson_ratio : {0.0, 0.3, 0.49, -0.3})
      for (Real softening : {0.0, 0.2, -0.4, 5.0})
        with_yield_surface(type, [&](auto law) {
          CAPTURE(std::string(law.kName));
          CAPTURE(poisson_ratio);
          CAPTURE(softening);
          const Real tau_c0 = 0.05;
          const auto k =
              convert_constants<S>(law_constants(material(type, poisson_ratio, tau_c0, softening)));
          Random random(7, static_cast<std::uint64_t>(type));
          int yields = 0;
          const int trials = 100000 / 16 * (softening == 0.2 && poisson_ratio == 0.3 ? 16 : 1);
          for (int n = 0; n < trials; ++n) {
            const Triple<S> trial = random_strain<S>(random);
            const S tau_c = S(tau_c0 * random.next());
            const ReturnMap<S> map = law.return_map(k, trial, tau_c);
            Triple<S> eps;
            for (int i = 0; i < 3; ++i) eps[i] = trial[i] - map.plastic[i];
            const S scale = S(1) + norm(principal_stress(k.mu2, k.lambda, trial));
            const S tol = tolerance * scale;
            // Admissible with the softened threshold, and the threshold stays a strength.
            REQUIRE(law.value(k, eps, map.tau_c) <= tol);
            REQUIRE(map.tau_c >= S(0));
            if (softening >= 0 && !find_parameter(type, "hardening")) REQUIRE(map.tau_c <= tau_c);
            // Elastic states are not touched; yielding is what value() says.
            REQUIRE(map.yielded == (law.value(k, trial, tau_c) > S(0)));
            if (!map.yielded) {
              REQUIRE(norm(map.plastic) == S(0));
              REQUIRE(map.tau_c == tau_c);
              REQUIRE(map.dissipation == S(0));
              continue;
            }
            ++yields;
            // Idempotent.
            const ReturnMap<S> again = law.return_map(k, eps, map.tau_c);
            REQUIRE(norm(again.plastic) <= 10 * tol);
            // Dissipative, and the energy identity of an associative flow:
            // psi(trial) - psi(eps) = tau(eps) : plastic + psi(plastic).
            const Triple<S> tau = principal_stress(k.mu2, k.lambda, eps);
            const S work =
                tau[0] * map.plastic[0] + tau[1] * map.plastic[1] + tau[2] * map.plastic[2];
            REQUIRE(work >= -tol * scale);
            REQUIRE(map.dissipation >= S(0));
            const S lost =
                energy_density(k.mu2, k.lambda, trial) - energy_density(k.mu2, k.lambda, eps);
            REQUIRE(std::abs(lost - work - energy_density(k.mu2, k.lambda, map.plastic)) <=
                    tol * scale);
            // Isotropic: the order of the strains does not matter.
            const ReturnMap<S> rolled =
                law.return_map(k, Triple<S>{{trial[2], trial[0], trial[1]}}, tau_c);
            for (int i = 0; i < 3; ++i)
              REQUIRE(std::abs(rolled.plastic[(i + 1) % 3] - map.plastic[i]) <= tol);
            REQUIRE(std::abs(rolled.tau_c - map.tau_c) <= tol * (S(1) + map.tau_c));
          }
          if (type > 0) CHECK(yields > trials / 10);
        });
}

}  // namespace

TEST_CASE("return mapping in double: admissible, idempotent, dissipative, isotropic") {
  check_properties<double>(1e-13);
}

TEST_CASE("return mapping in float: admissible, idempotent, dissipative, isotropic") {
  check_properties<float>(1e-5f);
}

TEST_CASE("Rankine is the closest point in the energy norm, whatever the softening") {
  const int type = *find_yield_surface("rankine");
  Random random(3, 1);
  for (Real softening : {0.0, 0.3}) {
    const auto k = law_constants(material(type, 0.3, 0.05, softening));
    for (int n = 0; n < 20000; ++n) {
      const Triple<Real> trial = random_strain<Real>(random);
      const auto map = Rankine::return_map(k, trial, 0.05);
      // KKT: plastic strain only where the stress is at the threshold, and never negative.
      const Triple<Real> eps{
          {trial[0] - map.plastic[0], trial[1] - map.plastic[1], trial[2] - map.plastic[2]}};
      const auto tau = principal_stress(k.mu2, k.lambda, eps);
      const Real tol = 1e-12 * (1 + norm(trial));
      for (int i = 0; i < 3; ++i) {
        REQUIRE(map.plastic[i] >= 0);
        REQUIRE(map.plastic[i] * std::abs(tau[i] - map.tau_c) <= tol);
      }
      // The softened threshold is the one that the plastic strain asks for.
      const Real driver = std::max({map.plastic[0], map.plastic[1], map.plastic[2]});
      REQUIRE(std::abs(map.tau_c - std::max(0.05 - softening * driver, 0.0)) <= tol);
    }
  }
}

TEST_CASE("pure pressure never yields von Mises and compression never yields Rankine") {
  const auto von_mises = law_constants(material(*find_yield_surface("von_mises"), 0.3, 1e-3, 0.1));
  const auto rankine = law_constants(material(*find_yield_surface("rankine"), 0.3, 1e-3, 0.1));
  Random random(11, 0);
  for (int n = 0; n < 10000; ++n) {
    const Real p = random.next(-3, 3);
    CHECK_FALSE(VonMises::return_map(von_mises, Triple<Real>{{p, p, p}}, 1e-3).yielded);
    // All principal stresses compressive.
    Triple<Real> e{{random.next(-1, 0), random.next(-1, 0), random.next(-1, 0)}};
    const auto tau = principal_stress(rankine.mu2, rankine.lambda, e);
    if (std::max({tau[0], tau[1], tau[2]}) <= 0)
      CHECK_FALSE(Rankine::return_map(rankine, e, 1e-3).yielded);
  }
}

TEST_CASE("snap-back drops the threshold to 0 in the step that yields") {
  const int type = *find_yield_surface("rankine");
  const MaterialDesc steep = material(type, 0.3, 0.05, 1.4);  // M = 1.346
  CHECK(snaps_back(steep));
  CHECK_FALSE(snaps_back(material(type, 0.3, 0.05, 1.3)));
  const auto k = law_constants(steep);
  const Real yield_strain = 0.05 / (k.mu2 + k.lambda);
  CHECK(Rankine::return_map(k, Triple<Real>{{yield_strain * 0.999, 0, 0}}, 0.05).tau_c == 0.05);
  const auto map = Rankine::return_map(k, Triple<Real>{{yield_strain * 1.001, 0, 0}}, 0.05);
  CHECK(map.tau_c == 0);
  CHECK(map.dissipation > 0);
}

TEST_CASE("extreme numbers stay finite") {
  for (int type = 1; type < yield_surface_count(); ++type)
    for (Real tau_c : {0.0, 1e-300, 1e12})
      for (Real softening : {0.0, 1e12}) {
        const auto k = law_constants(material(type, 0.3, tau_c, softening));
        with_yield_surface(type, [&](auto law) {
          for (Real e : {0.0, 1e-300, 1e-12, 7.0, -7.0}) {
            const auto map = law.return_map(k, Triple<Real>{{e, 0.5 * e, -e}}, tau_c);
            CHECK(std::isfinite(map.tau_c));
            CHECK(std::isfinite(norm(map.plastic)));
            CHECK(std::isfinite(map.dissipation));
          }
        });
      }
}
