// Positions: exact under rigid motion, continuous, and safe where a neighbourhood says little.
#include "engine/core/parallel.h"
#include "engine/core/random.h"
#include "engine/fracture/check_mesh.h"
#include "engine/fracture/rotation.h"
#include "tests/fracture/test_meshes.h"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

using namespace rend;

namespace {

Vec3 stay(const Vec3& X) { return X; }

Eigen::Quaterniond turn(Random& random) {
  const Eigen::Vector4d q(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1),
                          random.next(-1, 1));
  return Eigen::Quaterniond(q).normalized();
}

BreakTable random_table(const Model& model, Real share, std::uint64_t seed) {
  Random random(seed, 2);
  BreakTable table;
  for (const Edge& e : edges_of(model))
    if (random.next() < share) table.edge.push_back(e);
  table.frame.assign(table.edge.size(), 0);
  return table;
}

Real largest_distance(const SurfaceMesh& a, const SurfaceMesh& b) {
  REQUIRE(a.x.size() == b.x.size());
  Real worst = 0;
  for (std::size_t v = 0; v < a.x.size(); ++v) worst = std::max(worst, (a.x[v] - b.x[v]).norm());
  return worst;
}

}  // namespace

TEST_CASE("a rigid motion of the whole body moves every vertex rigidly") {
  const Model model = kuhn_box({5, 5, 5}, {1, 1, 1}, .25, 11);
  Random random(3, 3);
  for (Real share : {.05, .3, .6})
    for (Real distance : {0., 1., 1e4}) {
      const FractureMesh blank(plain_scene(), model);
      FractureMesh mesh = blank.playback(random_table(model, share, 5));
      mesh.update(moved(model, stay, 0));
      const Eigen::Quaterniond R = turn(random);
      const Vec3 t = distance * Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
      const Snapshot now = moved(
          model, [&](const Vec3& X) -> Vec3 { return R * X + t; }, 1);
      mesh.update(now);
      // One or two particles on their own do not know how they turned.
      const auto alone = [&](Index p) {
        const auto linked = mesh.crack().linked(p);
        return linked.empty() || (linked.size() == 1 && mesh.crack().linked(linked[0]).size() == 1);
      };
      const SurfaceMesh surface = mesh.surface(now);
      Real worst = 0;
      const auto& copies = mesh.crack().copies();
      const auto skin = static_cast<std::size_t>(mesh.crack().tables().skin_particle.size());
      for (std::size_t v = 0; v < surface.x.size(); ++v) {
        bool held = true;
        if (v >= skin)
          for (Index p : copies[v - skin].member) held &= p < 0 || !alone(p);
        if (held) worst = std::max(worst, (surface.x[v] - (R * surface.rest[v] + t)).norm());
      }
      CAPTURE(share);
      CHECK(worst <= 1e-12 * (1 + t.norm()));
    }
}

TEST_CASE("pieces that fly apart keep their shape") {
  const Model model = kuhn_box({6, 6, 6}, {1, 1, 1}, .25, 12);
  const auto left = [](const Vec3& X) { return X.x() < .52; };
  FractureMesh mesh(plain_scene(), model, table_of(edges_between(model, left)));
  mesh.update(moved(model, stay, 0));
  Random random(4, 4);
  const Eigen::Quaterniond R = turn(random);
  const Snapshot now = moved(
      model,
      [&](const Vec3& X) {
        return left(X) ? Vec3(R * X - Vec3(3, 0, 0)) : Vec3(X + Vec3(2, 1, 0));
      },
      1);
  mesh.update(now);
  const SurfaceMesh surface = mesh.surface(now);
  CHECK(check_mesh(surface).good());
  Real worst = 0;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    for (Index v : surface.triangles[i]) {
      const bool in_left = surface.x[v].x() < -0.5;
      const Vec3& X = surface.rest[v];
      worst = std::max(
          worst, (surface.x[v] - (in_left ? Vec3(R * X - Vec3(3, 0, 0)) : Vec3(X + Vec3(2, 1, 0))))
                     .norm());
    }
  CHECK(worst < 1e-12);
}

TEST_CASE("a cut opens continuously from zero, and positions follow the particles continuously") {
  const Model model = kuhn_box({5, 5, 5}, {1, 1, 1}, .25, 13);
  Random random(5, 5);
  std::vector<Vec3> noise(model.X.size());
  for (Vec3& n : noise) n = Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
  for (Real strain : {0., .1}) {
    const FractureMesh blank(plain_scene(), model);
    FractureMesh mesh = blank.playback(random_table(model, .3, 6));
    Snapshot a = moved(model, stay, 0);
    for (std::size_t p = 0; p < noise.size(); ++p) a.x[p] += strain * .2 * noise[p];
    mesh.update(a);
    Snapshot b = a;
    b.frame = 1;
    for (std::size_t p = 0; p < noise.size(); ++p) b.x[p] += 1e-9 * noise[noise.size() - 1 - p];
    const SurfaceMesh before = mesh.surface(a);
    CHECK(largest_distance(before, mesh.surface(b)) <= 1e-7);
    mesh.update(b);
    CHECK(largest_distance(before, mesh.surface(b)) <= 1e-7);
  }
  // Zero opening: the cut body still looks like the uncut one, both faces in the same place.
  FractureMesh mesh(plain_scene(), model,
                    table_of(edges_between(model, [](const Vec3& X) { return X.x() < .5; })));
  const Snapshot rest = moved(model, stay);
  mesh.update(rest);
  const SurfaceMesh surface = mesh.surface(rest);
  Real worst = 0;
  for (std::size_t v = 0; v < surface.x.size(); ++v)
    worst = std::max(worst, (surface.x[v] - surface.rest[v]).norm());
  CHECK(worst < 1e-13);
}

TEST_CASE("rotations: exact, proper, and kept where neighbours say nothing") {
  Random random(6, 6);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Quaterniond R = turn(random), start = turn(random);
    Mat3 B;
    for (int i = 0; i < 9; ++i) B(i) = random.next(-1, 1);
    const Mat3 S = B * B.transpose() + 1e-3 * Mat3::Identity();
    const Mat3 found = fit_rotation(R.toRotationMatrix() * S, start).toRotationMatrix();
    CHECK((found - R.toRotationMatrix()).norm() < 1e-9);
    CHECK(found.determinant() == doctest::Approx(1));
    // Flat neighbourhoods (rank 2) have one best rotation as well.
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(S);
    const Mat3 flat = S - eigen.eigenvalues()[0] * eigen.eigenvectors().col(0) *
                              eigen.eigenvectors().col(0).transpose();
    CHECK(
        (fit_rotation(R.toRotationMatrix() * flat, start).toRotationMatrix() - R.toRotationMatrix())
            .norm() < 1e-7);
    // Even a mirrored neighbourhood gives a rotation.
    CHECK(fit_rotation(-R.toRotationMatrix() * S, start).toRotationMatrix().determinant() ==
          doctest::Approx(1));
    // One neighbour: its direction is met, the rest comes from before.
    ShapeMoments line;
    const Vec3 X = Vec3(random.next(-1, 1), random.next(-1, 1), 1);
    line.add(R * X, X, 1);
    line.add_rest(X, 1);
    CHECK((line.rotation(start) * X - R * X).norm() < 1e-9);
    CHECK(ShapeMoments().rotation(start).coeffs() == start.coeffs());
  }
  CHECK(fit_rotation(Mat3::Zero(), Eigen::Quaterniond::Identity()).coeffs().allFinite());
  CHECK(fit_rotation(Mat3::Constant(NAN), Eigen::Quaterniond::Identity()).coeffs().allFinite());
}

TEST_CASE("flattened, crushed and inverted bodies give finite surfaces") {
  const Model model = kuhn_box({4, 4, 4}, {1, 1, 1}, .2, 14);
  const FractureMesh blank(plain_scene(), model);
  FractureMesh mesh = blank.playback(random_table(model, .3, 8));
  const Vec3 scales[] = {{1, 1, 0}, {1, 0, 0}, {0, 0, 0}, {1, 1, -1}, {1e-9, 1, 1}};
  Index frame = 0;
  for (const Vec3& scale : scales) {
    const Snapshot now = moved(
        model, [&](const Vec3& X) { return Vec3(scale.cwiseProduct(X)); }, frame++);
    mesh.update(now);
    CHECK(check_mesh(mesh.surface(now)).not_finite == 0);
  }
}

TEST_CASE("skin vertices lie on their particles, crack vertices between theirs") {
  const Model model = kuhn_box({5, 5, 5}, {1, 1, 1}, .25, 15);
  const FractureMesh blank(plain_scene(), model);
  FractureMesh mesh = blank.playback(random_table(model, .4, 9));
  const Snapshot rest = moved(model, stay);
  mesh.update(rest);
  const SurfaceMesh surface = mesh.surface(rest);
  for (const BrokenEdge& b : mesh.crack().broken_edges()) {
    CHECK(b.t >= .05);
    CHECK(b.t <= .95);
  }
  Real worst = 0;
  for (Index i = 0; i < surface.triangle_count(); ++i)
    if (!surface.interior[i])
      for (Index v : surface.triangles[i]) {
        const Vec3& X = surface.rest[v];
        worst = std::max(worst, std::min(X.minCoeff(), (Vec3::Ones() - X).minCoeff()));
      }
  CHECK(std::abs(worst) < 1e-15);
}

TEST_CASE("threads do not change a bit") {
  const Model model = kuhn_box({16, 16, 16}, {1, 1, 1}, .25, 16);
  std::vector<SurfaceMesh> result;
  for (int threads : {1, 3}) {
    set_thread_count(threads);
    const FractureMesh blank(plain_scene(), model);
    FractureMesh mesh = blank.playback(random_table(model, .2, 10));
    const Snapshot now =
        moved(model, [](const Vec3& X) { return Vec3(X + .1 * Vec3(X.y() * X.y(), X.x(), 0)); });
    mesh.update(now);
    result.push_back(mesh.surface(now));
  }
  set_thread_count(0);
  CHECK(result[0].x == result[1].x);
  CHECK(result[0].triangles == result[1].triangles);
  CHECK(std::equal(result[0].normal.begin(), result[0].normal.end(), result[1].normal.begin()));
}

TEST_CASE("while nothing breaks no vertex moves further than the particles around it") {
  const Model model = kuhn_box({8, 5, 5}, {1.6, 1, 1}, .25, 17);
  FractureMesh mesh = FractureMesh(plain_scene(), model).playback(random_table(model, .2, 8));
  const Real reach = 2 * mesh.crack().tables().mean_edge[0];
  // Bends, twists and stretches at once, a little further in every frame.
  const auto bent = [](Real amount) {
    return [amount](const Vec3& X) {
      const Eigen::AngleAxisd twist(amount * X.x(), Vec3::UnitX());
      return Vec3(twist * X + amount * Vec3(.3 * X.x() * X.y(), .2 * std::sin(4 * X.x()), 0));
    };
  };
  SurfaceMesh before;
  Snapshot old;
  for (int f = 0; f < 5; ++f) {
    const Snapshot now = moved(model, bent(.1 * f), f);
    mesh.update(now);
    const SurfaceMesh surface = mesh.surface(now);
    if (f > 0) {
      REQUIRE(surface.x.size() == before.x.size());
      Real worst = 0;
      for (std::size_t v = 0; v < surface.x.size(); ++v) {
        Real around = 0;
        for (std::size_t p = 0; p < model.X.size(); ++p)
          if ((model.X[p] - surface.rest[v]).norm() < reach)
            around = std::max(around, (now.x[p] - old.x[p]).norm());
        worst = std::max(worst, (surface.x[v] - before.x[v]).norm() / around);
      }
      CHECK(worst <= 1.001);
    }
    before = surface;
    old = now;
  }
}
