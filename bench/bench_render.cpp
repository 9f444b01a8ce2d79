// CPU time of a picture, stage by stage.
#include "bench/bench_render.h"

#include "bench/torn_shapes.h"
#include "render/image_file.h"
#include "render/light.h"
#include "render/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <ostream>

namespace rend {

namespace {

/// CPU time of the process in milliseconds: fair on a busy machine, where wall time is not.
double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

double least(int runs, const std::function<void()>& work) {
  double best = 1e30;
  for (int i = 0; i < runs; ++i) {
    const double start = cpu_ms();
    work();
    best = std::min(best, cpu_ms() - start);
  }
  return best;
}

Camera torus_camera() {
  Camera camera;
  camera.eye = Vec3(5.2, 2.85, 1.2);
  camera.target = Vec3(-0.08, 0.1, -0.03);
  camera.fov = 25.8;
  return camera;
}

}  // namespace

std::vector<RenderTiming> bench_render(bool quick) {
  std::vector<RenderTiming> out;
  Renderer renderer;
  Raster raster(GlBackend::automatic);
  const int runs = quick ? 5 : 15;
  for (const int size : {50000, 200000}) {
    const SurfaceMesh surface = torn_torus(size);
    DrawList list;
    list.surface = &surface;
    list.coloring.map = ColorMap::damage;
    list.coloring.value = surface.damage;
    list.coloring.caption = "Damage";
    const Camera camera = torus_camera();
    const auto add = [&](const char* stage, double ms) {
      out.push_back({surface.triangle_count(), stage, ms});
    };

    CornerMesh mesh;
    add("corners", least(runs, [&] {
          mesh = {};
          append_surface(surface, surface.damage, mesh);
        }));
    Bounds3f bounds;
    add("bounds", least(runs, [&] {
          bounds = {};
          for (const MeshVertex& v : mesh.vertices) bounds.add(Vec3f(v.x[0], v.x[1], v.x[2]));
        }));
    GroundMap ground;
    add("ground map", least(runs, [&] { ground = make_ground_map(mesh, {}, 0, 0, bounds); }));
    add("upload", least(runs, [&] { raster.upload(mesh, {}, 0); }));
    const PerspectiveView view = make_view(camera, 1280, 720, bounds);
    const Look look = make_look(list, view, bounds.center(), bounds.radius());
    DepthMap key;
    key.size = 512;
    add("shadow map",
        least(runs, [&] { raster.draw_depth(make_light_box(look.key_direction, bounds), key); }));
    GBuffer picture;
    LightPlanes planes;
    add("G-buffer", least(runs, [&] { raster.draw(view, picture); }));
    Image image;
    add("light", least(runs, [&] { image = planes.light(picture, view, key, ground, look); }));
    add("JPEG", least(runs, [&] { encode_jpeg(image); }));
    add("frame without JPEG", least(runs, [&] { renderer.draw(list, camera, {1280, 720, 1}); }));
    if (!quick)
      add("still 1920 x 1080, 64 passes", least(1, [&] {
            renderer.draw(list, camera, {1920, 1080, 64});
          }));
  }
  return out;
}

void print_render_bench(std::ostream& out, const std::vector<RenderTiming>& timings) {
  out << "triangles  CPU ms    stage\n";
  for (const RenderTiming& t : timings)
    out << fmt::format("{:9}  {:8.1f}  {}\n", t.triangles, t.cpu_ms, t.stage);
}

}  // namespace rend
