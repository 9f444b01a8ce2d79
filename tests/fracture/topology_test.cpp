// Any set of broken edges gives a closed, oriented 2-manifold that holds exactly the rest volume.
#include "engine/core/random.h"
#include "engine/fracture/check_mesh.h"
#include "engine/fracture/tet_templates.h"
#include "tests/fracture/test_meshes.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace rend;

namespace {

Vec3 stay(const Vec3& X) { return X; }

std::vector<Edge> random_edges(const Model& model, Real share, std::uint64_t seed) {
  Random random(seed, 1);
  std::vector<Edge> chosen;
  for (const Edge& e : edges_of(model))
    if (random.next() < share) chosen.push_back(e);
  return chosen;
}

Real total(const MeshCheck& check) {
  return std::accumulate(check.volume.begin(), check.volume.end(), Real(0));
}

// The number of components by flooding, with nothing shared with the code under test.
int flood_count(const Model& model, const std::vector<Edge>& broken) {
  std::vector<std::vector<Index>> links(model.X.size());
  for (const Edge& e : edges_of(model))
    if (!std::binary_search(broken.begin(), broken.end(), e))
      links[e[0]].push_back(e[1]), links[e[1]].push_back(e[0]);
  std::vector<int> seen(model.X.size(), 0);
  int count = 0;
  for (Index p = 0; p < model.particle_count(); ++p) {
    if (seen[p]) continue;
    ++count;
    std::vector<Index> stack{p};
    while (!stack.empty()) {
      const Index q = stack.back();
      stack.pop_back();
      if (seen[q]++) continue;
      stack.insert(stack.end(), links[q].begin(), links[q].end());
    }
  }
  return count;
}

SurfaceMesh cut_at_rest(const Model& model, const std::vector<Edge>& edges, int smoothing,
                        FractureReport* report = nullptr) {
  SceneDesc scene = plain_scene();
  scene.fracture.smoothing_iterations = smoothing;
  FractureMesh mesh(scene, model, table_of(edges));
  const Snapshot rest = moved(model, stay);
  mesh.update(rest);
  if (report) *report = mesh.report();
  return mesh.surface(rest);
}

void check_good(const SurfaceMesh& surface, Real volume, Real tolerance = 1e-12) {
  const MeshCheck check = check_mesh(surface);
  CHECK_MESSAGE(check.good(), check.text());
  CHECK(total(check) == doctest::Approx(volume).epsilon(tolerance));
  CHECK(enclosed_volume(surface) == doctest::Approx(volume).epsilon(tolerance));
}

}  // namespace

TEST_CASE("an uncut body is its skin, triangle by triangle") {
  const Model model = kuhn_box({3, 4, 5}, {1, 1, 1}, .2, 1);
  const SurfaceMesh surface = cut_at_rest(model, {}, 5);
  REQUIRE(surface.triangle_count() == static_cast<Index>(model.skin.size()));
  for (Index i = 0; i < surface.triangle_count(); ++i) {
    CHECK(surface.interior[i] == 0);
    for (int k = 0; k < 3; ++k)
      CHECK(surface.x[surface.triangles[i][k]] == model.X[model.skin[i][k]]);
  }
  check_good(surface, rest_volume(model));
}

TEST_CASE(
    "a template for every mask: closed with its neighbours, four triangles at most per broken "
    "edge") {
  Model tet;
  tet.X = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  tet.tets = {{0, 1, 3, 2}};
  tet.skin = boundary_of(tet);
  const std::vector<Edge> edges = edges_of(tet);
  for (int mask = 0; mask < 64; ++mask) {
    std::vector<Edge> broken;
    for (int e = 0; e < 6; ++e)
      if (mask >> e & 1) broken.push_back(edges[e]);
    CAPTURE(mask);
    const SurfaceMesh surface = cut_at_rest(tet, broken, 5);
    check_good(surface, rest_volume(tet));
    CHECK(tet_templates().tet[mask].triangle_count <= 4 * std::max<std::size_t>(1, broken.size()));
  }
}

TEST_CASE("a plane cut gives two closed halves, half a cut gives one") {
  const Model model = kuhn_box({6, 6, 6}, {1, 1, 1}, .2, 2);
  FractureReport report;
  const auto side = [](const Vec3& X) { return X.x() > 0.47; };
  check_good(cut_at_rest(model, edges_between(model, side), 5, &report), rest_volume(model));
  CHECK(report.pieces == 2);
  std::vector<Edge> half;
  for (const Edge& e : edges_between(model, side))
    if (model.X[e[0]].y() < .5 && model.X[e[1]].y() < .5) half.push_back(e);
  check_good(cut_at_rest(model, half, 5, &report), rest_volume(model));
  CHECK(report.pieces == 1);
}

TEST_CASE("random sets from 5 to 100 % of the edges, smoothed or not") {
  for (const Model& model : {kuhn_box({6, 6, 6}, {1, 1, 1}, .25, 3), bcc_cube(5)})
    for (Real share : {.05, .2, .4, .6, .9, 1.})
      for (int smoothing : {0, 5}) {
        CAPTURE(share);
        FractureReport report;
        const std::vector<Edge> broken =
            random_edges(model, share, static_cast<std::uint64_t>(100 * share));
        check_good(cut_at_rest(model, broken, smoothing, &report), rest_volume(model));
        CHECK(report.pieces == flood_count(model, broken));
      }
}

TEST_CASE("10000 random sets on small meshes, grown in steps") {
  const Model models[] = {kuhn_box({1, 1, 1}, {1, 1, 1}, 0, 1),
                          kuhn_box({2, 1, 1}, {2, 1, 1}, 0, 1), bcc_cube(1),
                          kuhn_box({2, 2, 1}, {2, 2, 1}, .2, 5)};
  SceneDesc scene = plain_scene();
  Index bad = 0;
  Real worst = 0;
  for (const Model& model : models) {
    const std::vector<Edge> edges = edges_of(model);
    const Real volume = rest_volume(model);
    const Snapshot rest[3] = {moved(model, stay, 0), moved(model, stay, 1), moved(model, stay, 2)};
    const FractureMesh blank(scene, model);
    for (std::uint64_t seed = 0; seed < 834; ++seed) {
      Random random(seed, 7);
      const Real share = random.next();
      BreakTable table;
      for (const Edge& e : edges)
        if (random.next() < share) {
          table.edge.push_back(e);
          table.frame.push_back(static_cast<Index>(3 * random.next()));
        }
      FractureMesh mesh = blank.playback(table);
      for (const Snapshot& snapshot : rest) {
        mesh.update(snapshot);
        const MeshCheck check = check_mesh(mesh.surface(snapshot));
        bad += !check.good();
        worst = std::max(worst, std::abs(total(check) / volume - 1));
      }
    }
  }
  CHECK(bad == 0);
  CHECK(worst < 1e-12);
}

TEST_CASE("bodies that touch in an edge or a point stay two manifold sheets") {
  Model model;
  model.X = {{0, 0, 0},   {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0},
             {-1, -1, 0}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
  model.tets = {
      {0, 2, 3, 1}, {0, 4, 5, 1}, {1, 7, 8, 6}};  // edge 0-1 in two fans, point 1 in two sheets
  model.skin = boundary_of(model);
  check_good(cut_at_rest(model, {}, 5), rest_volume(model));
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    check_good(cut_at_rest(model, random_edges(model, .4, seed), 5), rest_volume(model));
}
