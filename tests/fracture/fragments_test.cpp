// What is shown besides the whole truth: small fragments may be left out, edges close to breaking
// are told.
#include "engine/fracture/check_mesh.h"
#include "tests/fracture/test_meshes.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

using namespace rend;

namespace {

/// A box of two halves, and a crumb: the particle nearest to the centre of the first half comes
/// loose.
std::vector<Edge> halves_and_crumb(const Model& model) {
  const auto half = [](const Vec3& X) { return X.x() < 1.01 ? 0 : 1; };
  std::vector<Edge> edges = edges_between(model, half);
  const auto to_centre = [&](Index p) { return (model.X[p] - Vec3(.5, .5, .5)).norm(); };
  Index crumb = 0;
  for (Index p = 0; p < model.particle_count(); ++p)
    if (to_centre(p) < to_centre(crumb)) crumb = p;
  for (const Edge& e : edges_of(model))
    if (e[0] == crumb || e[1] == crumb) edges.push_back(e);
  return edges;
}

}  // namespace

TEST_CASE(
    "fragments below a size are left out whole; what remains is closed and keeps its volume") {
  const Model model = kuhn_box({8, 4, 4}, {2, 1, 1}, .2, 41);
  SceneDesc scene = plain_scene();
  const BreakTable table = table_of(halves_and_crumb(model));
  const Snapshot rest = moved(model, [](const Vec3& X) { return X; });
  const auto pieces_of = [&](int smallest) {
    scene.fracture.smallest_fragment = smallest;
    FractureMesh mesh(scene, model, table);
    mesh.update(rest);
    CHECK(mesh.report().pieces == 3);
    const SurfaceMesh surface = mesh.surface(rest);
    const MeshCheck check = check_mesh(surface);
    CAPTURE(check.text());
    CHECK(check.good());
    return check;
  };
  const MeshCheck all = pieces_of(1), same = pieces_of(0), large = pieces_of(2),
                  one = pieces_of(1000000);
  REQUIRE(all.piece.size() == 3);
  CHECK(same.piece == all.piece);
  CHECK(std::accumulate(all.volume.begin(), all.volume.end(), 0.) ==
        doctest::Approx(rest_volume(model)).epsilon(1e-12));
  REQUIRE(large.piece.size() == 2);
  for (std::size_t i = 0; i < large.piece.size(); ++i) {
    const auto at =
        std::find(all.piece.begin(), all.piece.end(), large.piece[i]) - all.piece.begin();
    CHECK(large.volume[i] == all.volume[static_cast<std::size_t>(at)]);
    CHECK(large.volume[i] > .5);
  }
  CHECK(one.piece.size() == 1);
}

TEST_CASE("nearness tells what share of its threshold an edge has used up") {
  const Model model = kuhn_box({4, 4, 4}, {1, 1, 1}, .2, 42);
  SceneDesc scene = plain_scene();
  scene.fracture.break_test = BreakTest::stretch;
  scene.fracture.stretch = 1.8;
  FractureMesh mesh(scene, model);
  const auto stretched = [&](Real stretch, Index frame) {
    return moved(
        model, [&](const Vec3& X) { return Vec3(stretch * X); }, frame);
  };
  mesh.update(stretched(1, 0));
  CHECK(*std::max_element(mesh.nearness().begin(), mesh.nearness().end()) == 0);
  const Snapshot now = stretched(1.4, 1);
  mesh.update(now);
  for (float share : mesh.nearness()) CHECK(share == doctest::Approx(.5).epsilon(1e-5));
  for (float share : mesh.surface(now).nearness) CHECK(share == doctest::Approx(.5).epsilon(1e-5));
}

TEST_CASE(
    "before a crack opens its particles are the nearest to breaking, those far away are not") {
  const Model model = kuhn_box({12, 6, 6}, {2, 1, 1}, .2, 43);
  const SceneDesc scene = plain_scene();
  FractureMesh mesh(scene, model);
  const Real edge = mesh.crack().tables().mean_edge[0];
  const auto opened = [&](Real gap, Index frame) {
    return moved(
        model, [&](const Vec3& X) { return Vec3(X + Vec3(X.x() < 1 ? 0 : gap * edge, 0, 0)); },
        frame);
  };
  mesh.update(opened(0, 0));
  mesh.update(opened(.4, 1));
  CHECK(mesh.report().broken_edges == 0);
  float beside = 1, far = 0;
  for (const Edge& e : edges_between(model, [](const Vec3& X) { return X.x() < 1 ? 0 : 1; }))
    beside = std::min(beside, std::max(mesh.nearness()[e[0]], mesh.nearness()[e[1]]));
  for (Index p = 0; p < model.particle_count(); ++p)
    if (std::abs(model.X[p].x() - 1) > .5) far = std::max(far, mesh.nearness()[p]);
  CHECK(beside > .6);
  CHECK(beside < 1);
  CHECK(far == 0);
  mesh.update(opened(.8, 2));
  CHECK(mesh.report().pieces == 2);
}
