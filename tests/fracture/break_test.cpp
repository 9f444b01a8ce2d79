// Which edges break: all across an opening crack, none in a body that only strains elastically.
#include "engine/core/error.h"
#include "engine/core/random.h"
#include "engine/fracture/check_mesh.h"
#include "tests/fracture/test_meshes.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

using namespace rend;

namespace {

Real mean_edge(const Model& model) {
  const std::vector<Edge> edges = edges_of(model);
  Real sum = 0;
  for (const Edge& e : edges) sum += (model.X[e[1]] - model.X[e[0]]).norm();
  return sum / static_cast<Real>(edges.size());
}

SceneDesc soft_scene(Real yield_strain) {
  SceneDesc scene = plain_scene();
  scene.materials[0].youngs_modulus = 1e5;
  scene.materials[0].yield_surface.type = *find_yield_surface("rankine");
  const int type = scene.materials[0].yield_surface.type;
  scene.materials[0].yield_surface.value[*find_parameter(type, "tau_c")] = 1e5 * yield_strain;
  return scene;
}

struct Found {
  Real share;        ///< of the crossing edges
  Real false_share;  ///< of the others
  FractureReport report;
  bool good;
};

Found open_crack(const Model& model, const SceneDesc& scene, const Vec3& opening, Real strain = 0,
                 int frames = 1, float damage = 1) {
  const Vec3 normal = Vec3(.36, .48, .8), origin(.5, .5, .51);
  const Vec3 along = Vec3(.8, 0, -.36).normalized();
  const Eigen::AngleAxisd Q(.7, Vec3(1, 2, 3).normalized());
  const auto side = [&](const Vec3& X) { return (X - origin).dot(normal) < 0; };
  const Vec3 jump = mean_edge(model) * (opening.x() * along + opening.z() * normal);
  FractureMesh mesh(scene, model);
  Snapshot now;
  for (int f = 1; f <= frames; ++f) {
    const Real share = static_cast<Real>(f) / frames;
    now = moved(
        model,
        [&](const Vec3& X) {
          const Vec3 strained = X + strain * (X - origin).dot(along) * along;
          return Vec3(Q * (strained + (side(X) ? -.5 : .5) * share * jump));
        },
        f, damage);
    now.yielded.assign(model.X.size(), 1);
    mesh.update(now);
  }
  const BreakTable table = mesh.break_table();
  std::size_t crossing = 0, hits = 0;
  const std::vector<Edge> edges = edges_of(model);
  for (const Edge& e : edges) crossing += side(model.X[e[0]]) != side(model.X[e[1]]);
  for (const Edge& e : table.edge) hits += side(model.X[e[0]]) != side(model.X[e[1]]);
  return {static_cast<Real>(hits) / static_cast<Real>(crossing),
          static_cast<Real>(table.edge.size() - hits) / static_cast<Real>(edges.size() - crossing),
          mesh.report(), check_mesh(mesh.surface(now)).good()};
}

}  // namespace

TEST_CASE("the gap test finds the whole crack at three quarters of an edge, opening or sliding") {
  for (const Model& model : {kuhn_box({10, 10, 10}, {1, 1, 1}, .25, 21), bcc_cube(8)})
    for (const Vec3& mode : {Vec3(0, 0, 1), Vec3(1, 0, 0)})
      for (Real strain : {0., .15}) {
        CAPTURE(mode.transpose());
        CAPTURE(strain);
        const Found at_once = open_crack(model, plain_scene(), .75 * mode, strain);
        CHECK(at_once.share >= .98);
        CHECK(at_once.false_share <= .001);
        CHECK(at_once.good);
        const Found slowly = open_crack(model, plain_scene(), 2 * mode, strain, 8);
        CHECK(slowly.share == 1);
        CHECK(slowly.false_share <= .001);
        CHECK(slowly.report.pieces == 2);
        // Even when the faces jump apart within one frame the neighbours across do not spoil the
        // rotations.
        const Found jump = open_crack(model, plain_scene(), 2 * mode, strain);
        CHECK(jump.share == 1);
        CHECK(jump.false_share <= .01);
      }
}

TEST_CASE("elastic strain does not cut, however large") {
  const Model model = kuhn_box({6, 6, 6}, {1, 1, 1}, .25, 22);
  for (Real strain : {.5, 1.}) {
    const auto stretched = [&](const Vec3& X) {
      return Vec3(X.x() * (1 + strain), X.y(), X.z() * .8);
    };
    FractureMesh sound(plain_scene(), model);
    sound.update(moved(model, stretched, 0, 0));
    CHECK(sound.report().broken_edges == 0);
    // A soft material that has just begun to yield still carries exp(tau_c / E) - 1 of elastic
    // strain.
    FractureMesh soft(soft_scene(.7), model);
    Snapshot yielding = moved(model, stretched, 0, 0);
    yielding.yielded.assign(model.X.size(), 1);
    soft.update(yielding);
    CHECK(soft.report().broken_edges == 0);
  }
  // Damage next door does not matter: an edge between two sound particles is not looked at.
  FractureMesh half(plain_scene(), model);
  Snapshot partly = moved(
      model, [](const Vec3& X) { return Vec3(2 * X.x(), X.y(), X.z()); }, 0, 0);
  for (std::size_t p = 0; p < model.X.size(); ++p)
    partly.damage[p] = model.X[p].x() < .4 ? 1.f : 0.f;
  half.update(partly);
  CHECK(half.report().broken_edges > 0);
  for (const Edge& e : half.break_table().edge)
    CHECK(partly.damage[e[0]] + partly.damage[e[1]] > 0);
  // The crack in it is found all the same once the material is damaged.
  CHECK(open_crack(model, soft_scene(.7), {0, 0, .75}, .15).share >= .98);
}

TEST_CASE("ductile flow does not cut, however far; what parts in it is found all the same") {
  const Model model = kuhn_box({12, 6, 6}, {2, 1, 1}, .25, 25);
  const Real h = mean_edge(model);
  const Eigen::AngleAxisd Q(.7, Vec3(1, 2, 3).normalized());
  const std::pair<const char*, std::function<Vec3(const Vec3&)>> flows[] = {
      {"stretched to four times",
       [](const Vec3& X) { return Vec3(4 * X.x(), X.y() / 2, X.z() / 2); }},
      {"flattened to a quarter",
       [](const Vec3& X) { return Vec3(2 * X.x(), X.y() / 4, 2 * X.z()); }},
      {"sheared by two", [](const Vec3& X) { return Vec3(X.x() + 2 * X.y(), X.y(), X.z()); }},
      {"a neck, stretched to three times in its middle",
       [](const Vec3& X) {
         const Real d = (X.x() - 1) / .4;
         const Real thin = 1 / std::sqrt(1 + 2 * std::exp(-d * d));
         return Vec3(X.x() + .4 * std::sqrt(M_PI) * std::erf(d), thin * (X.y() - .5),
                     thin * (X.z() - .5));
       }},
      {"a band of shear, four edges wide", [&](const Vec3& X) {
         return Vec3(X.x(), X.y() + 2 * h * std::tanh((X.x() - 1) / (2 * h)), X.z());
       }}};
  for (const auto& [name, flow] : flows)
    for (Real noise : {0., .1}) {
      CAPTURE(name);
      CAPTURE(noise);
      Random random(1, 1);
      FractureMesh mesh(plain_scene(), model);
      for (Real share : {.5, 1.}) {
        Snapshot now = moved(
            model,
            [&, flow = flow](const Vec3& X) {
              const Vec3 loose(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
              return Vec3(Q * (X + share * (flow(X) - X) + noise * h * loose));
            },
            static_cast<Index>(2 * share), 0);
        now.yielded.assign(model.X.size(), 1);
        mesh.update(now);
      }
      CHECK(mesh.report().broken_edges == 0);
    }
  // Without any loss of strength, neighbours that part are torn all the same: nine in ten at one
  // mean edge, where a map that gives way still explains some, all of them a little later.
  const Model cube = kuhn_box({10, 10, 10}, {1, 1, 1}, .25, 21);
  for (const Vec3& mode : {Vec3(0, 0, 1), Vec3(1, 0, 0)})
    for (Real strain : {0., .15}) {
      CAPTURE(mode.transpose());
      CAPTURE(strain);
      for (const auto& [opening, share] : {std::pair(1., .85), std::pair(2., .99)}) {
        const Found found = open_crack(cube, plain_scene(), opening * mode, strain, 1, 0);
        CHECK(found.share >= share);
        CHECK(found.false_share <= .001);
      }
      CHECK(open_crack(cube, plain_scene(), 3 * mode, strain, 12, 0).report.pieces == 2);
    }
}

TEST_CASE("the stretch test: at its threshold, never by rotation, at any scale") {
  for (Real scale : {1e-3, 1., 1e3}) {
    Model model = kuhn_box({4, 4, 4}, {1, 1, 1}, .2, 23);
    for (Vec3& X : model.X) X *= scale;
    SceneDesc scene = plain_scene();
    scene.fracture.break_test = BreakTest::stretch;
    scene.fracture.stretch = 1.8;
    const Eigen::AngleAxisd Q(2, Vec3(1, 2, 3).normalized());
    FractureMesh mesh(scene, model);
    mesh.update(moved(
        model, [&](const Vec3& X) { return Vec3(Q * X * 1.79); }, 0, 0));
    CHECK(mesh.report().broken_edges == 0);
    mesh.update(moved(
        model, [&](const Vec3& X) { return Vec3(Q * X * 1.81); }, 1, 0));
    CHECK(mesh.report().broken_edges == static_cast<Index>(edges_of(model).size()));
    CHECK(mesh.report().pieces == model.particle_count());
  }
}

TEST_CASE("auto stretch follows the strain at which the material yields") {
  const Model model = kuhn_box({2, 2, 2}, {1, 1, 1}, 0, 1);
  for (Real strain : {.1, 1.}) {
    SceneDesc scene = soft_scene(strain);
    scene.fracture.break_test = BreakTest::stretch;
    const Real limit = std::max(1.5, 1.3 * std::exp(strain));
    FractureMesh mesh(scene, model);
    mesh.update(moved(
        model, [&](const Vec3& X) { return Vec3(.99 * limit * X); }, 0));
    CHECK(mesh.report().broken_edges == 0);
    mesh.update(moved(
        model, [&](const Vec3& X) { return Vec3(1.01 * limit * X); }, 1));
    CHECK(mesh.report().broken_edges > 0);
  }
}

TEST_CASE("broken edges stay broken, pieces keep their names") {
  const Model model = kuhn_box({12, 4, 4}, {3, 1, 1}, .2, 24);
  const auto third = [](const Vec3& X) { return X.x() < 1.1 ? 0 : X.x() < 1.6 ? 1 : 2; };
  FractureMesh mesh(plain_scene(), model);
  const Vec3 away[3] = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}};
  const auto piece_at = [&](const SurfaceMesh& s, const Vec3& X) {
    std::size_t best = 0;
    for (std::size_t i = 0; i < s.triangles.size(); ++i)
      if ((s.rest[s.triangles[i][0]] - X).norm() < (s.rest[s.triangles[best][0]] - X).norm())
        best = i;
    return s.piece[best];
  };
  const Snapshot frames[] = {
      moved(
          model, [](const Vec3& X) { return X; }, 0),
      moved(
          model, [&](const Vec3& X) { return Vec3(X + away[third(X) == 2 ? 2 : 1]); }, 1),
      moved(
          model, [&](const Vec3& X) { return Vec3(X + away[third(X)]); }, 2),
      moved(
          model, [](const Vec3& X) { return X; }, 3)};
  const Index pieces[] = {1, 2, 3, 3};
  Index broken = 0;
  for (const Snapshot& now : frames) {
    mesh.update(now);
    const SurfaceMesh surface = mesh.surface(now);
    CHECK(mesh.report().pieces == pieces[now.frame]);
    CHECK(mesh.report().broken_edges >= broken);
    broken = mesh.report().broken_edges;
    // First the larger part keeps the first name, then the left end (now the largest of the rest)
    // inherits it.
    if (now.frame == 1) {
      CHECK(piece_at(surface, {0, .5, 1}) == 0);
      CHECK(piece_at(surface, {3, .5, 1}) == 1);
    }
    if (now.frame >= 2) {
      CHECK(piece_at(surface, {0, .5, 1}) == 0);
      CHECK(piece_at(surface, {1.3, .5, 1}) == 2);
      CHECK(piece_at(surface, {3, .5, 1}) == 1);
    }
    CHECK(check_mesh(surface).good());
  }
}

TEST_CASE("a snapshot of another model is refused") {
  const Model model = kuhn_box({2, 2, 2}, {1, 1, 1}, 0, 1);
  FractureMesh mesh(plain_scene(), model);
  CHECK_THROWS_WITH_AS(mesh.update(Snapshot{}), "snapshot: has 0 particles, the model has 27",
                       Error);
}
