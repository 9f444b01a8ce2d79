// The stable step: a lone particle is bounded just below the limit and blows up just above it.
#include "engine/mpm/time_step.h"
#include "tests/mpm/lattice_model.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace rend;

namespace {

// Largest growth of the strain of a lone particle over 600 steps at `share` of the stable step.
bool stays_bounded(const SolverDesc& solver, Real poisson_ratio, Real share, const Vec3& place,
                   Real start) {
  SceneDesc scene = plain_scene();
  scene.solver = solver;
  scene.materials[0].poisson_ratio = poisson_ratio;
  const Lame lame = lame_parameters(scene.materials[0].youngs_modulus, poisson_ratio);
  const Real bound = stable_share(solver) / std::sqrt(3 * lame.lambda + 2 * lame.mu);
  scene.solver.time_step = share * bound;
  LatticeModel one;
  one.add_box(place - Vec3::Constant(0.25), Vec3i(1, 1, 1), 0.5);
  // The isotropic mode sets the limit.
  one.model.velocity_gradient[0] = start / bound * Mat3::Identity();
  ReferenceSolver particle(scene, one.model);
  Real most = 0;
  for (int n = 0; n < 600; ++n) {
    if (particle.advance(scene.solver.time_step).status != Status::ok) return false;
    most = std::max(most, std::abs(std::log(particle.particles().F[0].determinant())) / 3);
    if (!(most < 40 * start)) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("a lone particle is stable at 0.9 of the limit and unstable at 1.1") {
  // Node position for the gradient form: there S is largest and the limit sharp is reached between
  // nodes.
  for (Real poisson_ratio : {0.0, 0.3, 0.49})
    for (Kernel kernel : {Kernel::quadratic, Kernel::cubic}) {
      CAPTURE(poisson_ratio);
      SolverDesc solver;
      solver.kernel = kernel;
      solver.transfer = Transfer::apic;
      solver.force_form = ForceForm::mls;
      for (const Vec3& place : {Vec3(0, 0, 0), Vec3(0.21, 0.4, 0.5), Vec3(0.499, 0.001, 0.25)}) {
        CHECK(stays_bounded(solver, poisson_ratio, 0.9, place, 0.01));
        CHECK(stays_bounded(solver, poisson_ratio, 0.9, place, 0.2));
        CHECK_FALSE(stays_bounded(solver, poisson_ratio, 1.1, place, 0.01));
      }
    }
}

TEST_CASE("the limits of the other schemes are safe") {
  for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic})
    for (ForceForm form : {ForceForm::mls, ForceForm::gradient})
      for (DeformationUpdate update : {DeformationUpdate::exponential, DeformationUpdate::linear}) {
        CAPTURE(static_cast<int>(transfer));
        CAPTURE(static_cast<int>(form));
        CAPTURE(static_cast<int>(update));
        SolverDesc solver;
        solver.transfer = transfer;
        solver.force_form = form;
        solver.deformation_update = update;
        for (const Vec3& place : {Vec3(0, 0, 0), Vec3(0.21, 0.4, 0.5), Vec3(0.499, 0.499, 0.499)})
          CHECK(stays_bounded(solver, 0.3, 0.9, place, 0.1));
      }
}

TEST_CASE(
    "the rule: stiffness, prestress, speed, strain rate, collider, fixed step, even division") {
  CHECK(wave_stiffness(1, 2, 5) == 8);
  CHECK(wave_stiffness(1, 0, -3) == 5);
  SolverDesc solver;
  solver.cfl = 0.5;
  MotionExtremes motion;
  motion.stiffness = 4;
  CHECK(choose_time_step(solver, 0.1, motion, 1e9) == doctest::Approx(0.5 * 0.1 / 2).epsilon(1e-6));
  motion.speed = 20;
  CHECK(choose_time_step(solver, 0.1, motion, 1e9) ==
        doctest::Approx(0.5 * 0.1 / 20).epsilon(1e-6));
  motion.collider_speed = 50;
  CHECK(choose_time_step(solver, 0.1, motion, 1e9) ==
        doctest::Approx(0.5 * 0.1 / 50).epsilon(1e-6));
  motion.gradient = 1e5;
  CHECK(choose_time_step(solver, 0.1, motion, 1e9) == doctest::Approx(0.25 / 1e5).epsilon(1e-6));
  solver.time_step = 0.3;
  CHECK(choose_time_step(solver, 0.1, motion, 0.9) == doctest::Approx(0.3));
  CHECK(choose_time_step(solver, 0.1, motion, 1.0) == doctest::Approx(0.25));
  CHECK(choose_time_step(solver, 0.1, motion, 0.1) == doctest::Approx(0.1));
}
