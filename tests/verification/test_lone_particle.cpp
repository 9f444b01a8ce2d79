// A particle without neighbours, as fracture makes them: stable at 0.9 and unstable at 1.1 of its
// bound, which is known in closed form for every scheme, kernel and force form.
#include "tests/verification/method.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

// The isotropic mode: strain e and velocity gradient c of the particle, k = 3K / (rho dx^2). Forces
// change node velocities by -dt k e dx^2 grad w / w, and the particle feels S = dx^2 sum (dw)^2 / w
// of that in its strain rate, d = dx^2 / D in the gradient that it keeps:
// e' = e + dt c - dt^2 k S e, c' = c - dt k d e with an affine velocity, e' = e - dt^2 k S e
// without. Stable for dt^2 k (2 S - d) <= 4 and dt^2 k S <= 2; the MLS form has S = d.
Real bound(const SolverDesc& solver, Real cell) {
  const bool cubic = solver.kernel == Kernel::cubic;
  const Real d = cubic ? 3 : 4;
  Real S = d;
  if (solver.force_form == ForceForm::gradient) {
    const auto sum = [&](auto stencil) {
      Real out = 0;
      for (int n = 0; n < decltype(stencil)::kNodes; ++n)
        if (stencil.w[0][n] > 0) out += stencil.dw[0][n] * stencil.dw[0][n] / stencil.w[0][n];
      return out;
    };
    const Vec3 x = Vec3::Constant(cell);
    S = cubic ? sum(Stencil<CubicKernel>(x, 1)) : sum(Stencil<QuadraticKernel>(x, 1));
  }
  const bool affine = solver.transfer == Transfer::apic || solver.transfer == Transfer::polypic;
  return affine ? 2 / std::sqrt(2 * S - d) : std::sqrt(2 / S);
}

// Largest isotropic strain over the first one in 800 steps at `share` of the bound.
Real growth(const SolverDesc& solver, Real poisson_ratio, Real cell, Real share) {
  SceneDesc scene = plain_scene();
  scene.solver = solver;
  scene.materials[0].poisson_ratio = poisson_ratio;
  const Lame lame = lame_parameters(scene.materials[0].youngs_modulus, poisson_ratio);
  const Real dt = share * bound(solver, cell) / std::sqrt(3 * lame.lambda + 2 * lame.mu);
  scene.solver.time_step = dt;
  LatticeModel one;
  one.add_box(Vec3::Constant(cell - 0.25), Vec3i(1, 1, 1), 0.5);
  const Real start = 1e-4;
  // The first step strains it, through the affine velocity or, where there is none, the nodes.
  one.model.velocity_gradient[0] = start / dt * Mat3::Identity();
  Trial trial(scene, one.model);
  if (solver.transfer != Transfer::apic && solver.transfer != Transfer::polypic)
    trial->set_node_rule([&](const Vec3& x, Real time, Real, const Vec3& v) {
      return time < 1.5 * dt ? Vec3(start / dt * (x - Vec3::Constant(cell))) : v;
    });
  Real most = 0;
  for (int n = 0; n < 800; ++n) {
    if (trial->advance(dt).status != Status::ok) return 1e9;
    const Matter now = trial.matter();
    const Real strain = now.tau[0].trace() / (3 * (3 * lame.lambda + 2 * lame.mu));
    most = std::max(most, std::abs(strain) / start);
    if (most > 1e3) return most;
  }
  return most;
}

}  // namespace

TEST_CASE("a lone particle is stable at 0.9 and unstable at 1.1 of the bound of its method") {
  for (Kernel kernel : {Kernel::quadratic, Kernel::cubic})
    for (ForceForm form : {ForceForm::mls, ForceForm::gradient})
      for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::rpic,
                                Transfer::polypic, Transfer::xpic})
        for (Precision precision : {Precision::float64, Precision::float32}) {
          const SolverDesc solver = method(transfer, kernel, form, precision);
          if (precision == Precision::float32) {
            SceneDesc scene;
            scene.solver = solver;
            if (!TileSolver::obstacle(scene).empty()) continue;
          }
          for (Real cell : {0.0, 0.2, 0.45})
            for (Real poisson_ratio : {0.0, 0.3, 0.49}) {
              CAPTURE(method_name(solver));
              CAPTURE(cell);
              CAPTURE(poisson_ratio);
              const Real below = growth(solver, poisson_ratio, cell, 0.9);
              const Real above = growth(solver, poisson_ratio, cell, 1.1);
              CHECK(below < 10);
              CHECK(above > 20);
              if (poisson_ratio == 0.3)
                MESSAGE(fmt::format(
                    "{:36} at {:.2f}: dt {:.3f} dx sqrt(rho / 3K), growth {:.2g}, {:.2g}",
                    method_name(solver), cell, bound(solver, cell), below, above));
            }
        }
}
