// V4 and V5: a bar in plane waves (uniaxial strain, one column of particles): its lowest mode
// against w = k c_p, and its impact on a wall against sigma = rho c_p v0, x = c_p t and contact for
// 2 L / c_p.
#include "tests/verification/method.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

// A bar of length 1 m along x from the origin, c_p about 1.16 m/s.
struct Bar {
  SceneDesc scene;
  LatticeModel body;
  Real c = 0, stiffness = 0;

  Bar(const SolverDesc& solver, int cells, Real courant = 0.2) : scene(plain_scene()) {
    const Real dx = 1.0 / cells;
    scene.grid.dx = dx;
    scene.solver = solver;
    scene.materials[0].youngs_modulus = 1;
    const Lame lame = lame_parameters(1, scene.materials[0].poisson_ratio);
    stiffness = lame.lambda + 2 * lame.mu;
    c = std::sqrt(stiffness);
    scene.solver.time_step = courant * dx / c;
    const Real spacing = dx / 2;
    body.add_box(Vec3(0, -0.5 * spacing, -0.5 * spacing), Vec3i(2 * cells, 1, 1), spacing);
  }
};

void wall(SceneDesc& scene, Contact contact) {
  ColliderDesc wall;
  wall.shape = PlaneDesc{Vec3(1, 0, 0)};
  wall.contact = contact;
  wall.motion = {Keyframe{}};
  scene.colliders.push_back(wall);
}

struct Mode {
  Real frequency;  // over the exact one, minus 1
  Real energy;     // of the last period over that of the first
};

// Free at both ends: u = a sin(w t) cos(pi x), w = pi c. Held at x = 0: u = a sin(w t) sin(pi x /
// 2).
Mode vibrate(const SolverDesc& solver, int cells, bool held, Real speed = 1e-4) {
  Bar bar(solver, cells);
  const Real k = held ? kPi / 2 : kPi, w = k * bar.c;
  const auto shape = [&](const Vec3& X) { return held ? std::sin(k * X[0]) : std::cos(k * X[0]); };
  for (std::size_t p = 0; p < bar.body.model.X.size(); ++p)
    bar.body.model.velocity[p][0] = speed * shape(bar.body.model.X[p]);
  if (held) wall(bar.scene, Contact::stick);
  Trial trial(bar.scene, bar.body.model);
  trial->set_node_rule(only_along(Vec3(1, 0, 0)));
  // Zero crossings of the modal displacement, and its amplitude in the first and the last period.
  Real before = 0, time = 0, last_zero = 0, first = 0, last = 0;
  int zeros = 0;
  const int periods = 5;
  while (zeros < 2 * periods) {
    const Real step = 5 * bar.scene.solver.time_step;
    REQUIRE(trial->advance(step).status == Status::ok);
    const Matter now = trial.matter();
    Real q = 0;
    for (std::size_t p = 0; p < now.x.size(); ++p)
      q += (now.x[p][0] - bar.body.model.X[p][0]) * shape(bar.body.model.X[p]);
    if (time > 0 && q * before < 0) {
      ++zeros;
      last_zero = time + step * before / (before - q);
    }
    if (zeros < 2) first = std::max(first, std::abs(q));
    if (zeros >= 2 * periods - 2) last = std::max(last, std::abs(q));
    before = q;
    time += step;
    REQUIRE(time < 3 * periods * 2 * kPi / w);
  }
  const Mode mode{periods * 2 * kPi / w / last_zero - 1, std::pow(last / first, 2)};
  MESSAGE(fmt::format("{:36} {} {} cells: frequency {:+.2e}, energy after 4 periods {:.4f}",
                      method_name(solver), held ? "held" : "free", cells, mode.frequency,
                      mode.energy));
  return mode;
}

struct Impact {
  Real stress;       // mean behind the front over rho c v0, minus 1
  Real front;        // error of its place [cells]
  Real overshoot;    // largest stress away from the wall over rho c v0, minus 1
  Real contact;      // time on the wall over 2 L / c, minus 1
  Real restitution;  // speed of the centre of mass after over before
};

Impact hit(const SolverDesc& solver, int cells) {
  Bar bar(solver, cells);
  const Real v0 = 1e-3 * bar.c, plateau = bar.c * v0;
  for (Vec3& v : bar.body.model.velocity) v[0] = -v0;
  wall(bar.scene, Contact::separate);
  Trial trial(bar.scene, bar.body.model);
  trial->set_node_rule(only_along(Vec3(1, 0, 0)));
  const Real mass = trial->snapshot().report.mass, dx = bar.scene.grid.dx;
  Impact out{};
  // Half the way of the front up the bar.
  const Real look = 0.6 / bar.c;
  REQUIRE(trial->advance(look).status == Status::ok);
  const Matter now = trial.matter();
  Real sum = 0, front = 0;
  int count = 0;
  for (std::size_t p = 0; p < now.x.size(); ++p) {
    const Real X = bar.body.model.X[p][0], pressure = -now.tau[p](0, 0) / plateau;
    if (X > 0.1) out.overshoot = std::max(out.overshoot, pressure - 1);
    if (X > 0.1 && X < 0.4) {
      sum += pressure;
      ++count;
    }
    if (pressure > 0.5) front = X + 0.25 * dx;
  }
  out.stress = sum / count - 1;
  out.front = (front - bar.c * look) / dx;
  Real left = 0, before = trial->snapshot().report.momentum[0];
  for (Real time = look; time < 3.2 / bar.c;) {
    const Real step = 5 * bar.scene.solver.time_step;
    const FrameReport report = trial->advance(step);
    REQUIRE(report.status == Status::ok);
    time += step;
    // The wall lets go when momentum has stopped growing.
    if (report.momentum[0] - before > 0.01 * plateau * bar.body.model.volume[0] / (dx / 2) * step)
      left = time;
    before = report.momentum[0];
  }
  out.contact = left * bar.c / 2 - 1;
  out.restitution = before / (mass * v0);
  MESSAGE(fmt::format(
      "{:36} {} cells: stress {:+.4f}, front {:+.2f} cells, overshoot {:.3f}, contact {:+.3f}, "
      "restitution {:.4f}",
      method_name(solver), cells, out.stress, out.front, out.overshoot, out.contact,
      out.restitution));
  return out;
}

}  // namespace

TEST_CASE("V4 free bar: frequency of order 2; PIC damps the mode, the others keep it") {
  for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::xpic})
    for (Kernel kernel : {Kernel::quadratic, Kernel::cubic})
      for (ForceForm form : {ForceForm::gradient, ForceForm::mls}) {
        if (kernel == Kernel::cubic && form == ForceForm::mls && !full_study()) continue;
        const SolverDesc solver = method(transfer, kernel, form);
        if (left_out(solver)) continue;
        CAPTURE(method_name(solver));
        const Mode coarse = vibrate(solver, 16, false), fine = vibrate(solver, 32, false);
        CHECK(std::abs(fine.frequency) < (transfer == Transfer::apic ? 2e-3 : 5e-3));
        CHECK(std::log2(coarse.frequency / fine.frequency) > 1.9);
        if (transfer == Transfer::pic)
          CHECK(fine.energy < 0.05);
        else
          CHECK(fine.energy > (transfer == Transfer::xpic ? 0.98 : 0.99));
        CHECK(fine.energy < 1.0001);
      }
}

TEST_CASE("V4 bar held by a collider: the wall is felt a third of a cell too deep, order 1") {
  for (Transfer transfer : {Transfer::flip, Transfer::apic})
    for (ForceForm form : {ForceForm::gradient, ForceForm::mls}) {
      const SolverDesc solver = method(transfer, Kernel::quadratic, form);
      CAPTURE(method_name(solver));
      const Mode coarse = vibrate(solver, 16, true), fine = vibrate(solver, 32, true);
      CHECK(std::abs(fine.frequency) * 32 < (form == ForceForm::mls ? 0.22 : 0.36));
      CHECK(std::log2(coarse.frequency / fine.frequency) == doctest::Approx(1).epsilon(0.2));
    }
}

TEST_CASE("V4 the float solver vibrates as the double one") {
  for (Transfer transfer : {Transfer::pic, Transfer::apic}) {
    SolverDesc solver = method(transfer);
    const Mode exact = vibrate(solver, 16, false, 0.01);
    solver.precision = Precision::float32;
    const Mode rounded = vibrate(solver, 16, false, 0.01);
    CHECK(std::abs(rounded.frequency - exact.frequency) < 1e-4);
    CHECK(rounded.energy == doctest::Approx(exact.energy).epsilon(1e-3));
  }
}

TEST_CASE("V5 bar against a wall: stress, front, time of contact, restitution") {
  const auto check = [](const SolverDesc& solver, const Impact& impact) {
    const Transfer transfer = solver.transfer;
    CAPTURE(method_name(solver));
    CHECK(std::abs(impact.stress) < 0.01);
    CHECK(std::abs(impact.front) < 1.5);
    CHECK(impact.overshoot < 0.25);
    CHECK(impact.restitution > (transfer == Transfer::pic ? 0.8 : 0.96));
    CHECK(impact.restitution < 1);
    // XPIC's last particles cling to the wall.
    if (transfer != Transfer::xpic) CHECK(std::abs(impact.contact) < 0.03);
  };
  for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::xpic})
    for (Kernel kernel : {Kernel::quadratic, Kernel::cubic})
      for (ForceForm form : {ForceForm::gradient, ForceForm::mls})
        if (full_study() || (kernel == Kernel::quadratic && form == ForceForm::mls)) {
          const SolverDesc solver = method(transfer, kernel, form);
          check(solver, hit(solver, 64));
        }
  const SolverDesc solver =
      method(Transfer::apic, Kernel::quadratic, ForceForm::mls, Precision::float32);
  check(solver, hit(solver, 64));
}
