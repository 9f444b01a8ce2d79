// The default scene from its file to the last of 48 frames: it tears, nothing is lost, every surface is closed.
#include "app/pipeline.h"
#include "app/scene_library.h"
#include "engine/fracture/check_mesh.h"

#include <doctest/doctest.h>

using namespace rend;

TEST_CASE("the notched bar tears; mass is constant and every surface is a closed 2-manifold") {
  const SceneDesc scene = SceneLibrary(REND_SOURCE_DIR).read("tear");
  const auto model = std::make_shared<Model>(build_model(scene));
  CHECK(model->particle_count() == doctest::Approx(20000).epsilon(0.1));
  Pipeline pipeline(scene, model);
  const Frame first = pipeline.current();
  const Real mass = first.snapshot->report.mass;
  const Real volume = enclosed_volume(*first.surface);
  Frame frame;
  for (int n = 1; n <= 48; ++n) {
    frame = pipeline.advance();
    CAPTURE(n);
    const FrameReport& report = frame.snapshot->report;
    CAPTURE(report.reason);
    REQUIRE(report.status == Status::ok);
    CHECK(report.mass == mass);
    const MeshCheck check = check_mesh(*frame.surface);
    CAPTURE(check.text());
    CHECK(check.good());
    CHECK(enclosed_volume(*frame.surface) == doctest::Approx(volume).epsilon(0.1));
  }
  CHECK(frame.fracture.pieces >= 2);
}
