// What lies under a point of the picture: matter, a grip before it, or nothing.
#include "app/pixel_probe.h"
#include "engine/core/error.h"
#include "engine/mesh/build_model.h"
#include "engine/scene/scene_reader.h"
#include "tests/app/program.h"

#include <doctest/doctest.h>

using namespace rend;

namespace {

struct Bar {
  SceneDesc scene = parse_scene(test::small_scene(), "small.json", ".");
  std::shared_ptr<Model> model = std::make_shared<Model>(build_model(scene));
  Stage stage = make_stage(scene, *model);
  Pipeline pipeline{scene, model};
  View view = default_view(scene);

  // Straight along -z, the bar across the picture.
  Bar() {
    view.camera = {Vec3(0, 0, 2), Vec3::Zero(), Vec3::UnitY(), 30};
    view.width = 800;
    view.height = 400;
  }
};

}  // namespace

TEST_CASE("probe: the middle of the bar, at rest and after some frames") {
  Bar bar;
  const auto rest = probe_pixel(bar.stage, *bar.model, bar.pipeline.current(), bar.view, 0.5, 0.5);
  REQUIRE(rest);
  CHECK((rest->position - Vec3(0, 0, 0.075)).norm() < 1e-6);
  CHECK((rest->rest - rest->position).norm() < 1e-6);
  CHECK(rest->threshold == doctest::Approx(8e3));
  CHECK(rest->material == "clay");
  CHECK(rest->damage == 0);
  CHECK(!rest->yielded);
  CHECK((bar.model->X[static_cast<std::size_t>(rest->particle)] - rest->rest).norm() < 0.05);

  Frame frame;
  for (int n = 0; n < 3; ++n) frame = bar.pipeline.advance();
  const auto later = probe_pixel(bar.stage, *bar.model, frame, bar.view, 0.58, 0.5);
  REQUIRE(later);
  CHECK((later->position - later->rest).norm() > 1e-4);
  const auto p = static_cast<std::size_t>(later->particle);
  CHECK((frame.snapshot->x[p] - later->position).norm() < 0.05);
  CHECK(later->stress == frame.snapshot->stress[p]);
  CHECK((later->velocity - frame.snapshot->v[p].cast<Real>()).norm() == 0);
}

TEST_CASE("probe: right and left, up and down are those of the picture") {
  Bar bar;
  const Frame frame = bar.pipeline.current();
  const auto right = probe_pixel(bar.stage, *bar.model, frame, bar.view, 0.6, 0.47);
  REQUIRE(right);
  CHECK(right->position.x() > 0.1);
  CHECK(right->position.y() > 0.01);
}

TEST_CASE("probe: a grip in front, the background, and a hidden grip") {
  Bar bar;
  const Frame frame = bar.pipeline.current();
  CHECK(!probe_pixel(bar.stage, *bar.model, frame, bar.view, 0.5, 0.05));
  const Real on_grip = 0.5 + 0.28 / (2 * 1.925 * 0.26795 * 2);
  CHECK(!probe_pixel(bar.stage, *bar.model, frame, bar.view, on_grip, 0.5));
  for (ColliderDesc& collider : bar.stage.scene.colliders) collider.visible = false;
  CHECK(probe_pixel(bar.stage, *bar.model, frame, bar.view, on_grip, 0.5));
}

TEST_CASE("probe: among particles the nearest sphere counts") {
  Bar bar;
  bar.view.particles = true;
  const auto found = probe_pixel(bar.stage, *bar.model, bar.pipeline.current(), bar.view, 0.5, 0.5);
  REQUIRE(found);
  CHECK(found->piece == -1);
  CHECK(found->rest.z() > 0.04);
  CHECK((found->position - found->rest).norm() <= particle_radius(bar.stage) * 1.0001);
  CHECK(!probe_pixel(bar.stage, *bar.model, bar.pipeline.current(), bar.view, 0.5, 0.05));
}
