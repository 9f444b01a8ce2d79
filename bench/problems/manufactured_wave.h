// A manufactured solution of large-strain elasticity: standing waves along the axes of a unit cube.
#pragma once

#include "bench/problems/trial.h"
#include "engine/material/law_constants.h"

#include <cmath>

namespace rend {

/// u_i = A/2 sin(pi X_i) (1 - cos(k_i pi c t)), axis-aligned, from rest, after Wallstedt and
/// Guilkey (J. Comput. Phys. 227, 2008, 9628) with Hencky's law: F and tau are diagonal, tau_i = 2
/// mu ln F_i
/// + lambda ln J, and the body force that it needs is
/// b_i = d2u_i/dt2 + pi^2 u_i (2 mu + lambda - tau_i) / (rho F_i^2).
struct ManufacturedWave {
  Real amplitude = 1e-4;
  Vec3 k = Vec3(1, 2.0 / 3, 4.0 / 3);  ///< 0: no motion along this axis
  Real density = 1;
  Lame lame;
  Real c = 1;  ///< sqrt(E / rho)

  explicit ManufacturedWave(const MaterialDesc& material)
      : density(material.density),
        lame(lame_parameters(material.youngs_modulus, material.poisson_ratio)),
        c(std::sqrt(material.youngs_modulus / material.density)) {}

  Vec3 displacement(const Vec3& X, Real t) const {
    return each([&](int a) { return shape(X, a) * (1 - std::cos(rate(a) * t)); });
  }
  Vec3 velocity(const Vec3& X, Real t) const {
    return each([&](int a) { return shape(X, a) * rate(a) * std::sin(rate(a) * t); });
  }
  Vec3 stretch(const Vec3& X, Real t) const {
    return each([&](int a) {
      return 1 + 0.5 * amplitude * kPi * std::cos(kPi * X[a]) * (1 - std::cos(rate(a) * t));
    });
  }
  Vec3 stress(const Vec3& X, Real t) const {
    const Vec3 e = stretch(X, t).array().log();
    return 2 * lame.mu * e + Vec3::Constant(lame.lambda * e.sum());
  }
  Vec3 body_force(const Vec3& X, Real t) const {
    const Vec3 u = displacement(X, t), F = stretch(X, t), tau = stress(X, t);
    return each([&](int a) {
      const Real inertia = shape(X, a) * rate(a) * rate(a) * std::cos(rate(a) * t);
      return inertia +
             kPi * kPi * u[a] * (2 * lame.mu + lame.lambda - tau[a]) / (density * F[a] * F[a]);
    });
  }
  /// Rest position of the matter that is at x (Newton; converges for amplitudes below 0.1).
  Vec3 rest(const Vec3& x, Real t) const {
    Vec3 X = x;
    for (int n = 0; n < 5; ++n) X -= (X + displacement(X, t) - x).cwiseQuotient(stretch(X, t));
    return X;
  }

  /// Body force inside the cube, the exact velocity on it and outside; `thin` keeps particles of a
  /// single column still across. Velocities live at half steps (leapfrog).
  NodeRule rule(bool thin) const {
    return [wave = *this, thin](const Vec3& x, Real time, Real dt, const Vec3& v) {
      const Real t = time - dt;
      const Vec3 X = wave.rest(x, t);
      bool inside = true;
      for (int a = 0; a < (thin ? 1 : 3); ++a) inside = inside && X[a] > 1e-9 && X[a] < 1 - 1e-9;
      Vec3 out = inside ? Vec3(v + dt * wave.body_force(X, t)) : wave.velocity(X, t + 0.5 * dt);
      if (thin) out[1] = out[2] = 0;
      return out;
    };
  }

  Real speed() const { return std::sqrt((2 * lame.mu + lame.lambda) / density); }

 private:
  template <class F>
  static Vec3 each(F&& f) {
    return {f(0), f(1), f(2)};
  }
  Real rate(int a) const { return k[a] * kPi * c; }
  Real shape(const Vec3& X, int a) const { return 0.5 * amplitude * std::sin(kPi * X[a]); }
};

/// How a wave is run: cells a unit length, particles a cell and axis, step over dx / c_p.
struct WaveRun {
  int cells = 16;
  int per_axis = 2;
  Real courant = 0.2;
  Real amplitude = 1e-4;
  bool thin = true;       ///< one column of particles along x instead of a cube
  bool mesh = false;      ///< forces of a tet mesh on the vertices of a lattice
  bool half_step = true;  ///< start from v(-dt/2) instead of v(0)
  Real duration = 1;      ///< in units of 1 / c
};

/// Largest error over the output times, relative to the largest value of the exact solution;
/// infinite when the run stopped.
struct WaveErrors {
  Real u = 0, v = 0, tau = 0;  ///< tau stays 0 with mesh forces, which know it on elements only
  std::vector<Real> last;      ///< final displacement along x of the particles inside
  RunCost cost;
};

WaveErrors run_wave(const SolverDesc& solver, const WaveRun& run);

/// Cost of `steps` steps of the same matter that swings free. The rule of the manufactured solution
/// costs more than a step of the tile solver, and no other run has it.
RunCost time_wave(const SolverDesc& solver, const WaveRun& run, Index steps);

/// Order of a sequence of errors between its last two members, each made with half the last step.
inline Real order(const std::vector<Real>& errors) {
  return std::log2(errors[errors.size() - 2] / errors.back());
}

}  // namespace rend
