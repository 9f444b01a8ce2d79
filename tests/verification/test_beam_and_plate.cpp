// V8 and V11: a cantilever under its weight against Timoshenko's beam, and a plate with a hole
// against Kirsch's field with Heywood's factor for a finite width; plane strain.
#include "tests/verification/method.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

struct Beam {
  Real deflection, period;  // over theory, minus 1
};

// Released from rest a beam of 8 x 1 m swings about its static deflection.
Beam swing(const SolverDesc& solver, int cells_across) {
  SceneDesc scene = plain_scene();
  const Real dx = 1.0 / cells_across, spacing = dx / 2, length = 8, g = 0.2, E = 1e4;
  scene.grid.dx = dx;
  scene.solver = solver;
  scene.materials[0].youngs_modulus = E;
  scene.gravity = Vec3(0, -g, 0);
  ColliderDesc clamp;
  clamp.shape = PlaneDesc{Vec3(1, 0, 0)};
  clamp.contact = Contact::stick;
  clamp.motion = {Keyframe{}};
  scene.colliders.push_back(clamp);
  LatticeModel body;
  body.add_box(Vec3(-2 * dx, 0, -0.5 * spacing),
               Vec3i((8 * cells_across + 2) * 2, 2 * cells_across, 1), spacing);
  const Real nu = scene.materials[0].poisson_ratio;
  const Real bending = E / (1 - nu * nu) / 12, shear = 5.0 / 6 * E / (2 * (1 + nu));
  const Real deflection =
      g * std::pow(length, 4) / (8 * bending) + g * length * length / (2 * shear);
  const Real period = 2 * kPi / (std::pow(1.87510407, 2) / (length * length) * std::sqrt(bending));

  Trial trial(scene, body.model);
  trial->set_node_rule(only_along(Vec3(1, 1, 0)));
  // The tip turns around after one period of the lowest mode; its mean until then is static.
  std::vector<std::size_t> tip;
  for (std::size_t p = 0; p < body.model.X.size(); ++p)
    if (body.model.X[p][0] > length - spacing) tip.push_back(p);
  Real before = 0, rising = 0, mean = 0, time = 0;
  const Real step = period / 200;
  bool up = false;
  for (int n = 1; n < 300; ++n) {
    REQUIRE(trial->advance(step).status == Status::ok);
    const Matter now = trial.matter();
    Real w = 0;
    for (std::size_t p : tip)
      w += (body.model.X[p][1] - now.x[p][1]) / static_cast<Real>(tip.size());
    const Real change = w - before;
    if (n > 120 && n < 180 && change < 0) up = true;
    if (up && n > 150 && change > 0) {
      time = (n - 1) * step + step * rising / (rising - change) - 0.5 * step;
      mean /= n - 1;
      break;
    }
    mean += w;
    rising = change;
    before = w;
  }
  const Beam out{mean / deflection - 1, time / period - 1};
  MESSAGE(fmt::format(
      "{:28} {} cells across: deflection {:+.3f}, period {:+.3f} of theory ({:.4f} m, {:.3f} s)",
      method_name(solver), cells_across, out.deflection, out.period, deflection, period));
  return out;
}

struct Plate {
  Real peak;   // stress of the particle next to the hole over theory there, minus 1
  Real field;  // root mean square difference from theory along the ligament, over the far stress
};

// A plate of 10 x 15 radii is pulled slowly along y.
Plate pull(const SolverDesc& solver, int cells_a_radius) {
  SceneDesc scene = plain_scene();
  const Real dx = 1.0 / cells_a_radius, spacing = dx / 2, half_width = 5, half_length = 7.5;
  scene.grid.dx = dx;
  scene.solver = solver;
  const Lame lame = lame_parameters(100, scene.materials[0].poisson_ratio);
  const Real c = std::sqrt(lame.lambda + 2 * lame.mu);
  LatticeModel body;
  body.add_box(Vec3(-half_width, -half_length, -0.5 * spacing),
               Vec3i(20 * cells_a_radius, 30 * cells_a_radius, 1), spacing, Vec3::Zero(), 0, 0,
               [](const Vec3& x) { return x.head<2>().norm() > 1; });
  const Real strain = 1e-3, duration = 8 * 2 * half_length / c,
             speed = strain * half_length / duration;
  Trial trial(scene, body.model);
  const Real grip = half_length - dx;
  trial->set_node_rule([=](const Vec3& x, Real time, Real, const Vec3& v) {
    Vec3 out(v[0], v[1], 0);
    // A bell in time, so that the pull begins and ends smoothly.
    const Real s = std::min(time / duration, 1.0), bell = 2 * std::pow(std::sin(kPi * s), 2);
    if (std::abs(x[1]) > grip) out[1] = std::copysign(speed * bell, x[1]);
    return out;
  });
  REQUIRE(trial->advance(1.25 * duration).status == Status::ok);
  const Matter now = trial.matter();
  Real far = 0, n_far = 0;
  for (std::size_t p = 0; p < now.x.size(); ++p)
    if (std::abs(std::abs(body.model.X[p][1]) - 4.5) < 0.5) {
      far += now.tau[p](1, 1);
      n_far += 1;
    }
  far /= n_far;
  // Heywood (1952): the net stress concentrates by 2 + (1 - d/W)^3; Kirsch (1898) along y = 0.
  const Real open = 1 - 1 / half_width, factor = (2 + open * open * open) / open / 3;
  Plate out{};
  Real sum = 0, n = 0, nearest = 1e9;
  for (std::size_t p = 0; p < now.x.size(); ++p) {
    const Vec3& X = body.model.X[p];
    if (std::abs(X[1]) > spacing) continue;
    const Real r = X.head<2>().norm();
    if (r > 2.5) continue;
    const Real q = 1 / (r * r), theory = factor * (1 + 0.5 * q + 1.5 * q * q);
    const Real error = now.tau[p](1, 1) / far - theory;
    if (r > 1 + dx) {
      sum += error * error;
      n += 1;
    }
    if (r < nearest) {
      nearest = r;
      out.peak = error / theory;
    }
  }
  out.field = std::sqrt(sum / n);
  MESSAGE(fmt::format(
      "{:28} {} cells a radius: next to the hole (r = {:.3f}) {:+.3f} of theory, field {:.3f}",
      method_name(solver), cells_a_radius, nearest, out.peak, out.field));
  return out;
}

}  // namespace

TEST_CASE("V8 cantilever: static deflection and period of the lowest mode") {
  const SolverDesc tile =
      method(Transfer::apic, Kernel::quadratic, ForceForm::mls, Precision::float32);
  const Beam coarse = swing(tile, 4);
  CHECK(std::abs(coarse.deflection) < 0.04);
  CHECK(std::abs(coarse.period) < 0.02);
  if (!full_study()) return;
  const Beam fine = swing(tile, 8);
  CHECK(std::abs(fine.deflection) < 0.02);
  CHECK(std::abs(fine.period) < 0.01);
  for (Kernel kernel : {Kernel::quadratic, Kernel::cubic})
    for (Transfer transfer : {Transfer::flip, Transfer::apic, Transfer::xpic})
      CHECK(std::abs(swing(method(transfer, kernel, ForceForm::gradient), 4).deflection) < 0.08);
}

TEST_CASE("V11 plate with a hole: Kirsch's field, and the stress next to the hole") {
  const SolverDesc tile =
      method(Transfer::apic, Kernel::quadratic, ForceForm::mls, Precision::float32);
  for (int cells : full_study() ? std::vector<int>{4, 6, 8, 12} : std::vector<int>{4}) {
    const Plate plate = pull(tile, cells);
    CHECK(std::abs(plate.peak) < 0.12);
    CHECK(plate.field < 0.04);
  }
}
