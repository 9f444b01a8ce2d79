// The renderer as a whole: refusals, coverage, no specks, both GL backends.
#include "render/renderer.h"
#include "bench/torn_shapes.h"
#include "engine/core/error.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

using namespace rend;

namespace {

Camera front_camera() {
  Camera camera;
  camera.eye = Vec3(0, 1, 5);
  camera.target = Vec3(0, 0.5, 0);
  camera.fov = 26;
  return camera;
}

int luma(const Image& image, int x, int y) {
  const std::uint8_t* p = &image.rgb[3 * static_cast<std::size_t>(y * image.width + x)];
  return (299 * p[0] + 587 * p[1] + 114 * p[2]) / 1000;
}

}  // namespace

TEST_CASE("sizes and cameras outside the range are refused") {
  Renderer renderer;
  const DrawList list;
  for (const auto& [width, height] :
       {std::pair{0, 10}, {10, 0}, {-1, 10}, {8193, 10}, {10, 100000}})
    CHECK_THROWS_AS(renderer.draw(list, front_camera(), {width, height, 1}), Error);
  CHECK_THROWS_AS(renderer.draw(list, front_camera(), {64, 64, 0}), Error);
  Camera camera = front_camera();
  camera.fov = 0;
  CHECK_THROWS_AS(renderer.draw(list, camera, {64, 64, 1}), Error);
  camera = front_camera();
  camera.target = camera.eye;
  CHECK_THROWS_AS(renderer.draw(list, camera, {64, 64, 1}), Error);
  camera.eye.x() = std::numeric_limits<Real>::quiet_NaN();
  CHECK_THROWS_AS(renderer.draw(list, camera, {64, 64, 1}), Error);
  CHECK(renderer.draw(list, front_camera(), {1, 1, 1}).rgb.size() == 3);
}

TEST_CASE("a surface with bad indices or lengths is refused") {
  Renderer renderer;
  SurfaceMesh mesh = sphere_surface(Vec3(0, 0.5, 0), 0.5, 8);
  DrawList list;
  list.surface = &mesh;
  mesh.triangles[3][1] = mesh.vertex_count();
  CHECK_THROWS_AS(renderer.draw(list, front_camera(), {64, 64, 1}), Error);
  mesh.triangles[3][1] = 0;
  mesh.crease.pop_back();
  CHECK_THROWS_AS(renderer.draw(list, front_camera(), {64, 64, 1}), Error);
}

TEST_CASE("positions that are not finite leave holes, not failures") {
  Renderer renderer;
  SurfaceMesh mesh = sphere_surface(Vec3(0, 0.5, 0), 0.5, 16);
  DrawList list;
  list.surface = &mesh;
  const Image whole = renderer.draw(list, front_camera(), {160, 120, 1});
  mesh.x[5].y() = std::numeric_limits<Real>::infinity();
  mesh.x[40].x() = std::numeric_limits<Real>::quiet_NaN();
  const Image torn = renderer.draw(list, front_camera(), {160, 120, 1});
  int same = 0;
  for (std::size_t i = 0; i < whole.rgb.size(); ++i)
    same += std::abs(whole.rgb[i] - torn.rgb[i]) < 30;
  CHECK(same > static_cast<int>(whole.rgb.size() * 9 / 10));
}

TEST_CASE("a lit sphere and its floor have no isolated bright or dark pixels") {
  Renderer renderer;
  const SurfaceMesh mesh = sphere_surface(Vec3(0, 0.5, 0), 0.5, 64);
  for (const Theme theme : {Theme::light, Theme::dark}) {
    DrawList list;
    list.surface = &mesh;
    list.theme = theme;
    const Image image = renderer.draw(list, front_camera(), {640, 480, 1});
    int specks = 0;
    for (int y = 1; y + 1 < image.height; ++y)
      for (int x = 1; x + 1 < image.width; ++x) {
        int high = 0, low = 255;
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i)
            if (i || j) {
              high = std::max(high, luma(image, x + i, y + j));
              low = std::min(low, luma(image, x + i, y + j));
            }
        const int here = luma(image, x, y);
        specks += here > high + 8 || here < low - 8;
      }
    CHECK(specks == 0);
  }
}

TEST_CASE("a plane face has no stripes of shadow, however the light grazes it") {
  Renderer renderer;
  DrawList list;
  list.props = bar_grips();
  constexpr int half = 48, reach = 6;
  double worst = 0;
  for (int degrees = -60; degrees <= 60; degrees += 10) {
    const double turn = degrees * std::numbers::pi / 180;
    Camera camera;
    camera.target = Vec3(1.11, 0.55, 0);  // the middle of the outer face of a grip
    camera.eye = camera.target + 2 * Vec3(std::cos(turn), 0.2, std::sin(turn));
    camera.fov = 26;
    const Image image = renderer.draw(list, camera, {640, 480, 1});
    std::vector<double> mean(2 * half);
    for (int x = 0; x < 2 * half; ++x)
      for (int y = -half; y < half; ++y)
        mean[x] += luma(image, 320 - half + x, 240 + y) / (2. * half);
    for (int x = reach; x + reach < 2 * half; ++x) {
      double around = 0;
      for (int i = -reach; i <= reach; ++i) around += mean[x + i] / (2 * reach + 1);
      worst = std::max(worst, std::abs(mean[x] - around));
    }
  }
  MESSAGE("largest stripe: " << worst << " levels of 255");
  CHECK(worst < 0.2);
}
