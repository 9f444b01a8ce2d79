// V2: generalised vortex (Kamojjala and Brannon 2011): rings of a plane body turn by different
// angles, a large shear with rotation; the body force is that of Hencky's law.
#include "tests/verification/method.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

// A ring of rest radius R turns by alpha = A sin(pi t) (1 - 16 (R - 1)^2)^4 between 3/4 and 5/4
// (the published square has a body force that jumps at the edges, which costs an order). In polar
// axes that turn with it F = 1 + g e_t e_r with g = R alpha', and with f = 2 mu asinh(g/2) / (g
// sqrt(1 + g^2/4)) the first Piola stress is P_rr = P_tt = -f g^2 / 2, P_tr = f g, P_rt = f (g +
// g^3/2). Momentum in rest polar coordinates then gives rho b_r = -rho R alpha_t^2 - (P_rr' -
// alpha' P_tr + (P_rr - P_tt) / R), rho b_t = rho R alpha_tt - (P_tr' + alpha' P_rr + (P_tr + P_rt)
// / R).
struct Vortex {
  Real amplitude = 0.1, mu = 1, density = 1;

  Real angle(Real R, Real t) const { return amplitude * std::sin(kPi * t) * profile(R); }
  Real rate(Real R, Real t) const { return kPi * amplitude * std::cos(kPi * t) * profile(R); }

  static Real profile(Real R) {
    const Real s = 1 - 16 * (R - 1) * (R - 1);
    return s > 0 ? s * s * s * s : 0;
  }
  static Real slope(Real R) {
    const Real s = 1 - 16 * (R - 1) * (R - 1);
    return s > 0 ? -128 * (R - 1) * s * s * s : 0;
  }
  struct Piola {
    Real rr, tr, rt;
  };
  Piola piola(Real R, Real t) const {
    const Real g = R * amplitude * std::sin(kPi * t) * slope(R);
    const Real f =
        std::abs(g) < 1e-8 ? mu : 2 * mu * std::asinh(g / 2) / (g * std::sqrt(1 + g * g / 4));
    return {-0.5 * f * g * g, f * g, f * (g + 0.5 * g * g * g)};
  }
  // Body force in the polar axes of the place.
  std::pair<Real, Real> body_force(Real R, Real t) const {
    if (profile(R) == 0) return {0, 0};
    const Real h = 1e-5, turning = amplitude * std::sin(kPi * t) * slope(R), w = rate(R, t);
    const Piola P = piola(R, t), above = piola(R + h, t), below = piola(R - h, t);
    const Real divergence_r = (above.rr - below.rr) / (2 * h) - turning * P.tr;
    const Real divergence_t = (above.tr - below.tr) / (2 * h) + turning * P.rr + (P.tr + P.rt) / R;
    return {-R * w * w - divergence_r / density,
            -R * kPi * kPi * angle(R, t) - divergence_t / density};
  }

  NodeRule rule() const {
    return [vortex = *this](const Vec3& x, Real time, Real dt, const Vec3& v) {
      const Real R = std::hypot(x[0], x[1]);
      const auto [radial, along] = vortex.body_force(R, time - dt);
      const Vec3 e(x[0] / R, x[1] / R, 0), across(-e[1], e[0], 0);
      Vec3 out = v + dt * (radial * e + along * across);
      out[2] = 0;
      return R > 0.1 ? out : Vec3(Vec3::Zero());
    };
  }
};

// Largest displacement error over the largest displacement, at the time of largest shear.
Real whirl(const SolverDesc& solver, int cells) {
  SceneDesc scene = plain_scene();
  const Real dx = 1.0 / cells, spacing = dx / 2, duration = 0.5;
  scene.grid.dx = dx;
  scene.solver = solver;
  scene.materials[0].youngs_modulus = 1;
  const Lame lame = lame_parameters(1, scene.materials[0].poisson_ratio);
  Vortex vortex;
  vortex.mu = lame.mu;
  scene.solver.time_step = 0.2 * dx / std::sqrt(lame.lambda + 2 * lame.mu);
  LatticeModel body;
  const int count = 2 * static_cast<int>(std::ceil(1.5 / spacing));
  body.add_box(Vec3(-0.5 * count * spacing, -0.5 * count * spacing, -0.5 * spacing),
               Vec3i(count, count, 1), spacing, Vec3::Zero(), 0, 0, [](const Vec3& x) {
                 const Real R = std::hypot(x[0], x[1]);
                 return R > 0.6 && R < 1.4;
               });
  for (std::size_t p = 0; p < body.model.X.size(); ++p) {
    const Vec3& X = body.model.X[p];
    body.model.velocity[p] = vortex.rate(std::hypot(X[0], X[1]), 0) * Vec3(-X[1], X[0], 0);
  }
  Trial trial(scene, body.model);
  trial->set_node_rule(vortex.rule());
  REQUIRE(trial->advance(duration).status == Status::ok);
  const Matter now = trial.matter();
  Real error = 0, size = 0;
  for (std::size_t p = 0; p < now.x.size(); ++p) {
    const Vec3& X = body.model.X[p];
    const Real a = vortex.angle(std::hypot(X[0], X[1]), duration);
    const Vec3 exact(X[0] * std::cos(a) - X[1] * std::sin(a),
                     X[0] * std::sin(a) + X[1] * std::cos(a), X[2]);
    error += (now.x[p] - exact).squaredNorm();
    size += (exact - X).squaredNorm();
  }
  return std::sqrt(error / size);
}

}  // namespace

TEST_CASE("V2 generalised vortex: displacement of order 2 under large shear and rotation") {
  const auto study = [](const SolverDesc& solver, int coarse, int fine) {
    std::string row;
    std::vector<Real> errors;
    for (int cells = coarse; cells <= fine; cells *= 2) {
      errors.push_back(whirl(solver, cells));
      row += fmt::format("  {}: {:.2e}", cells, errors.back());
    }
    const Real order = std::log2(errors[errors.size() - 2] / errors.back());
    MESSAGE(fmt::format("{:36} order {:.2f} |{}", method_name(solver), order, row));
    return std::pair(errors.back(), order);
  };
  const auto [error, order] =
      study(method(Transfer::apic, Kernel::quadratic, ForceForm::mls, Precision::float32), 16,
            brief_study() ? 32 : 64);
  CHECK(error < (brief_study() ? 3e-2 : 8e-3));
  CHECK(order > (brief_study() ? 1.3 : 1.8));
  // Sixteen cells a ring width are not yet where the orders settle, but the solvers agree there.
  CHECK(
      whirl(method(Transfer::apic), 16) ==
      doctest::Approx(
          whirl(method(Transfer::apic, Kernel::quadratic, ForceForm::mls, Precision::float32), 16))
          .epsilon(1e-3));
  CHECK(study(method(Transfer::flip, Kernel::quadratic, ForceForm::gradient), 16, 32).second > 1.9);
  if (!full_study()) return;
  for (Kernel kernel : {Kernel::quadratic, Kernel::cubic})
    CHECK(study(method(Transfer::apic, kernel, ForceForm::gradient), 16, 64).second > 1.5);
  for (Transfer transfer : {Transfer::pic, Transfer::rpic, Transfer::polypic, Transfer::xpic})
    study(method(transfer), 16, 64);
}
