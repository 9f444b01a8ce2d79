// V15, V16, V17 and balances: motions whose answer is exact for every method: free fall, a block
// sliding with Coulomb friction, mirror symmetry, linear and angular momentum.
#include "tests/mpm/kuhn_model.h"
#include "tests/verification/method.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

std::vector<SolverDesc> every_method() {
  std::vector<SolverDesc> all;
  for (Kernel kernel : {Kernel::quadratic, Kernel::cubic})
    for (ForceForm form : {ForceForm::gradient, ForceForm::mls})
      for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::rpic,
                                Transfer::polypic, Transfer::xpic})
        all.push_back(method(transfer, kernel, form));
  for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::rpic})
    all.push_back(method(transfer, Kernel::quadratic, ForceForm::mls, Precision::float32));
  return all;
}

// A box that flies, turns and vibrates.
LatticeModel shaken_box() {
  LatticeModel body;
  body.add_box(Vec3(-2, -1.5, -1), Vec3i(8, 6, 4), 0.5, Vec3(0.7, -0.3, 0.2), 0.3);
  body.spin(0, Vec3::Zero(), Vec3(0.1, 0.2, -0.15));
  Random random(9, 9);
  for (Vec3& v : body.model.velocity)
    v += 0.5 * Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
  return body;
}

Model shaken_mesh() {
  Model model = kuhn_box(Vec3(-2, -1.5, -1), Vec3i(8, 6, 4), 0.5);
  Random random(9, 9);
  for (std::size_t p = 0; p < model.X.size(); ++p)
    model.velocity[p] = Vec3(0.7, -0.3, 0.2) + Vec3(0.1, 0.2, -0.15).cross(model.X[p]) +
                        0.5 * Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
  return model;
}

bool keeps_spin(Transfer transfer) {
  return transfer == Transfer::apic || transfer == Transfer::rpic || transfer == Transfer::polypic;
}

struct Drift {
  Real momentum, spin;
};

Drift drift(SceneDesc scene, const Model& model) {
  Trial trial(scene, model);
  const FrameReport before = trial->snapshot().report;
  FrameReport after;
  const Index wanted = test::by_effort(100, 1000, 1000);
  for (Index steps = 0; steps < wanted; steps += after.substeps) {
    after = trial->advance(1);
    REQUIRE(after.status == Status::ok);
  }
  return {
      (after.momentum - before.momentum).norm() / before.momentum.norm(),
      (after.angular_momentum - before.angular_momentum).norm() / before.angular_momentum.norm()};
}

}  // namespace

TEST_CASE("1000 steps keep momentum, and angular momentum with affine velocities") {
  for (ForceKind force : {ForceKind::particle, ForceKind::mesh})
    for (const SolverDesc& solver : every_method()) {
      const bool common = solver.transfer == Transfer::apic || solver.transfer == Transfer::flip;
      if (!full_study() && !common &&
          (solver.kernel == Kernel::cubic || solver.force_form != ForceForm::mls ||
           force == ForceKind::mesh))
        continue;
      if (force == ForceKind::mesh && solver.force_form == ForceForm::gradient) continue;
      SceneDesc scene = plain_scene();
      scene.solver = solver;
      scene.bodies.emplace_back().force = force;
      scene.solver.time_step = 0.02;
      const Drift d = drift(scene, force == ForceKind::mesh ? shaken_mesh() : shaken_box().model);
      const bool rounded = solver.precision == Precision::float32;
      MESSAGE(fmt::format("{:36} {} forces: momentum {:.1e}, angular momentum {:.1e}",
                          method_name(solver), force == ForceKind::mesh ? "mesh" : "particle",
                          d.momentum, d.spin));
      CAPTURE(method_name(solver));
      CHECK(d.momentum < (rounded ? 5e-7 : 1e-12));
      if (keeps_spin(solver.transfer)) CHECK(d.spin < (rounded ? 1e-5 : 1e-12));
    }
}

TEST_CASE("the drift of momentum in float over the number of particles" *
          doctest::skip(!full_study())) {
  for (Transfer transfer : {Transfer::apic, Transfer::flip})
    for (int scale : {1, 2, 4, 8}) {
      LatticeModel body;
      const Vec3i count = scale * Vec3i(8, 6, 4);
      body.add_box(Vec3(-2, -1.5, -1), count, 0.5, Vec3(0.7, -0.3, 0.2), 0.3);
      body.spin(0, Vec3(-2, -1.5, -1) + 0.25 * count.cast<Real>(), Vec3(0.1, 0.2, -0.15) / scale);
      Random random(9, 9);
      for (Vec3& v : body.model.velocity)
        v += 0.5 * Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
      SceneDesc scene = plain_scene();
      scene.solver = method(transfer, Kernel::quadratic, ForceForm::mls, Precision::float32);
      scene.solver.time_step = 0.02;
      const Drift d = drift(scene, body.model);
      MESSAGE(fmt::format("{:28} {} particles: momentum {:.1e}", method_name(scene.solver),
                          body.model.X.size(), d.momentum));
      CHECK(d.momentum < (transfer == Transfer::apic && scale == 1 ? 5e-7 : 1e-7));
    }
}

TEST_CASE("a body that flies freely keeps its velocity to the last bit in float") {
  for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::rpic}) {
    SceneDesc scene = plain_scene();
    scene.solver = method(transfer, Kernel::quadratic, ForceForm::mls, Precision::float32);
    scene.solver.time_step = 0.02;
    // Rounding to the nearest number below 1, where they lie closer, than above would be a trend.
    const Vec3 v0(1, -0.3, 0.7);
    LatticeModel body;
    body.add_box(Vec3::Zero(), Vec3i(8, 6, 4), 0.5, v0, 0.3);
    Trial trial(scene, body.model);
    for (int frame = 0; frame < 4; ++frame) REQUIRE(trial->advance(2).status == Status::ok);
    CAPTURE(method_name(scene.solver));
    for (const Vec3f& v : trial->snapshot().v) CHECK((v - v0.cast<float>()).norm() == 0);
  }
}

TEST_CASE("V15 free fall: x0 + v0 t + g t (t + dt) / 2") {
  for (const SolverDesc& solver : every_method()) {
    SceneDesc scene = plain_scene();
    scene.solver = solver;
    scene.gravity = Vec3(0.3, -9.81, 0.1);
    scene.solver.time_step = 0.004;
    const Vec3 v0(1, 2, -0.5);
    LatticeModel body;
    body.add_box(Vec3::Zero(), Vec3i(5, 4, 3), 0.5, v0, 0.3);
    Trial trial(scene, body.model);
    REQUIRE(trial->advance(0.8).status == Status::ok);
    const Real t = 0.8, dt = 0.004;
    const Vec3 path = v0 * t + scene.gravity * t * (t + dt) / 2;
    const Matter now = trial.matter();
    // In float, 200 steps round positions to 1e-7 cells, all particles the same way.
    Real worst = 0;
    for (std::size_t p = 0; p < now.x.size(); ++p)
      worst = std::max(worst, (now.x[p] - body.model.X[p] - path).norm() / path.norm());
    CAPTURE(method_name(solver));
    CHECK(worst < (solver.precision == Precision::float32 ? 4e-6 : 1e-12));
  }
}

TEST_CASE("V16 a block slides down a slope: g t (sin a - f cos a), or stays") {
  for (Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic})
    for (Precision precision : {Precision::float64, Precision::float32}) {
      const SolverDesc solver = method(transfer, Kernel::quadratic, ForceForm::mls, precision);
      for (Real friction : {0.0, 0.3, 0.8}) {
        SceneDesc scene = plain_scene();
        const Real dt = 0.005;
        scene.solver = solver;
        scene.solver.time_step = dt;
        scene.materials[0].youngs_modulus = 1e4;
        // Without sideways motion all friction acts along x.
        scene.materials[0].poisson_ratio = 0;
        // The slope lies level and gravity is turned by 30 degrees.
        const Real angle = kPi / 6, g = 10;
        scene.gravity = g * Vec3(std::sin(angle), -std::cos(angle), 0);
        ColliderDesc slope;
        slope.shape = PlaneDesc{Vec3(0, 1, 0)};
        slope.contact = Contact::separate;
        slope.friction = friction;
        slope.motion = {Keyframe{}};
        scene.colliders.push_back(slope);
        LatticeModel block;
        const Vec3 v0(friction > 0.6 ? 0 : 1, 0, 0);
        block.add_box(Vec3(0, 0, 0), Vec3i(8, 4, 8), 0.5, v0);
        Trial trial(scene, block.model);
        const Real t = 2;
        const FrameReport report = trial->advance(t);
        REQUIRE(report.status == Status::ok);
        const Matter now = trial.matter();
        Real x = 0, vx = 0, vy = 0;
        for (std::size_t p = 0; p < now.x.size(); ++p) {
          const Real share = 1 / static_cast<Real>(now.x.size());
          x += share * (now.x[p][0] - block.model.X[p][0]);
          vx += share * now.v[p][0];
          vy += share * now.v[p][1];
        }
        MESSAGE(fmt::format("{:30} friction {:.1f}: v {:.6f}, x {:.6f}, vy {:.1e}",
                            method_name(solver), friction, vx, x, vy));
        CAPTURE(method_name(solver));
        CAPTURE(friction);
        if (friction > 0.6) {
          CHECK(std::abs(x) < 4e-3 * 0.5 * g * std::sin(angle) * t * t);
          continue;
        }
        const Real a = g * (std::sin(angle) - friction * std::cos(angle));
        CHECK(x == doctest::Approx(v0[0] * t + 0.5 * a * t * (t + dt)).epsilon(1e-3));
        // Friction is exactly f times the impulse of the wall, which is what is left of the fall.
        const Real impulse = g * std::cos(angle) * t + vy;
        const bool rounded = precision == Precision::float32;
        CHECK(vx == doctest::Approx(v0[0] + g * std::sin(angle) * t - friction * impulse)
                        .epsilon(rounded ? 1e-5 : 1e-10));
      }
    }
}

TEST_CASE("V17 an explosion stays symmetric in all octants") {
  for (const SolverDesc& solver : every_method()) {
    if (solver.kernel == Kernel::cubic && !full_study()) continue;
    SceneDesc scene = plain_scene();
    scene.solver = solver;
    scene.solver.time_step = 0.02;
    scene.materials[0] = with_surface(scene.materials[0], "von_mises", 2, 0);
    LatticeModel ball;
    const int n = 12;
    const Real spacing = 0.5;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k) {
          const Vec3 x = spacing * (Vec3(i, j, k) + Vec3::Constant(0.5 - n / 2));
          if (x.norm() > 3) continue;
          ball.model.X.push_back(x);
          ball.model.velocity.push_back(x * (3 - x.norm()));
        }
    const std::size_t count = ball.model.X.size();
    ball.model.volume.assign(count, 0.125);
    ball.model.body.assign(count, 0);
    ball.model.material.assign(count, 0);
    ball.model.crease.assign(count, 0);
    ball.model.velocity_gradient.assign(1, Mat3::Zero());
    ball.model.spacing.assign(1, spacing);
    Trial trial(scene, ball.model);
    const FrameReport report = trial->advance(2);
    REQUIRE(report.status == Status::ok);
    CHECK(report.yielded > 0);
    const Matter now = trial.matter();
    Real worst = 0;
    // Ids run over the lattice, so that mirrored particles are found by their rest position.
    for (std::size_t p = 0; p < count; ++p)
      for (std::size_t q = 0; q < count; ++q)
        if ((ball.model.X[p].cwiseAbs() - ball.model.X[q].cwiseAbs()).isZero(0)) {
          const Vec3 sign = ball.model.X[p].cwiseQuotient(ball.model.X[q]);
          worst = std::max(worst, (now.x[p] - now.x[q].cwiseProduct(sign)).norm());
        }
    MESSAGE(fmt::format("{:36} largest difference {:.1e} cells", method_name(solver), worst));
    CAPTURE(method_name(solver));
    CHECK(worst < (solver.precision == Precision::float32 ? 1e-5 : 1e-12));
  }
}
