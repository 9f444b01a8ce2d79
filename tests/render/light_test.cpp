// The light alone: lanes against double precision, threads, blown-up input, backends.
#include "render/light.h"

#include "bench/torn_shapes.h"
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "render/raster.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

using namespace rend;

namespace {

/// A torn torus with everything the light needs, rasterised once.
struct Stage {
  GBuffer picture;
  DepthMap key;
  GroundMap ground;
  PerspectiveView view;
  Look look;
  CornerMesh mesh;

  Stage(int width, int height, Theme theme, GlBackend backend = GlBackend::automatic) {
    const SurfaceMesh surface = torn_torus(20000);
    append_surface(surface, surface.damage, mesh);
    Bounds3f bounds;
    for (const MeshVertex& v : mesh.vertices) bounds.add(Vec3f(v.x[0], v.x[1], v.x[2]));
    Camera camera;
    camera.eye = Vec3(5.2, 2.85, 1.2);
    camera.target = Vec3(-0.08, 0.1, -0.03);
    camera.fov = 26;
    view = make_view(camera, width, height, bounds);
    DrawList list;
    list.theme = theme;
    list.coloring.map = ColorMap::damage;
    look = make_look(list, view, bounds.center(), bounds.radius());
    look.normal_offset = 0.008f;
    look.depth_bias = 0.0005f;
    ground = make_ground_map(mesh, {}, 0, 0, bounds);
    Raster raster(backend);
    raster.upload(mesh, {}, 0);
    key.size = 512;
    LightBox box;
    box.direction = look.key_direction;
    box.u = Vec3f(0, 1, 0).cross(box.direction).normalized();
    box.v = box.direction.cross(box.u);
    box.center = bounds.center();
    box.half = box.depth = 1.15f * bounds.radius();
    raster.draw_depth(box, key);
    raster.draw(view, picture);
  }
};

using Arithmetic = LightPlanes::Arithmetic;

Image light(const Stage& s, Arithmetic arithmetic = Arithmetic::lanes) {
  return LightPlanes(arithmetic).light(s.picture, s.view, s.key, s.ground, s.look);
}

/// Two passes, one with occlusion and one for which the key's own map stands in for that of the
/// sky.
Image still(const Stage& s, Arithmetic arithmetic = Arithmetic::lanes) {
  LightPlanes planes(arithmetic);
  Look look = s.look;
  look.sky_direction = look.key_direction;
  for (const DepthMap* sky : {static_cast<const DepthMap*>(nullptr), &s.key})
    planes.add_pass(s.picture, s.view, s.key, s.ground, sky, look);
  return planes.finish_still(look);
}

struct Difference {
  int most = 0;
  double share = 0;  ///< of bytes that differ by more than one level
};

Difference compare(const Image& a, const Image& b) {
  REQUIRE(a.rgb.size() == b.rgb.size());
  Difference d;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    const int off = std::abs(a.rgb[i] - b.rgb[i]);
    d.most = std::max(d.most, off);
    d.share += off > 1;
  }
  d.share /= static_cast<double>(a.rgb.size());
  return d;
}

}  // namespace

TEST_CASE("lanes agree with double precision to one level") {
  for (const Theme theme : {Theme::light, Theme::dark})
    for (const auto& [width, height] : {std::pair{640, 360}, {333, 217}}) {
      const Stage s(width, height, theme);
      const Difference d = compare(light(s), light(s, Arithmetic::reference));
      // Comparisons (shadow texels, occlusion taps) that fall between float and double flip single
      // pixels.
      CHECK(d.share < 3e-4);
      CHECK(d.most <= 12);
      const Difference e = compare(still(s), still(s, Arithmetic::reference));
      CHECK(e.share < 3e-4);
      CHECK(e.most <= 12);
    }
}

TEST_CASE("the picture has the same bytes for one and two threads") {
  const Stage s(640, 360, Theme::light);
  set_thread_count(1);
  const Image one = light(s);
  set_thread_count(2);
  const Image two = light(s);
  set_thread_count(0);
  CHECK(one.rgb == two.rgb);
}

TEST_CASE("occlusion and light stay finite whatever the G-buffer holds") {
  Stage s(320, 180, Theme::light);
  const Image clean = light(s);
  // Values no rasteriser should write: they may spoil their neighbourhood, never the rest.
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity(), -1.0f, 0.0f};
  for (std::size_t k = 0; k < 4; ++k) {
    s.picture.depth[(40 + k) * static_cast<std::size_t>(s.picture.stride) + 60 * k + 20] = bad[k];
    s.picture.surface[(40 + k) * static_cast<std::size_t>(s.picture.stride) + 60 * k + 20] = ~0u;
  }
  const Image spoiled = light(s);
  int changed = 0;
  for (std::size_t i = 0; i < clean.rgb.size(); i += 3)
    changed += std::abs(clean.rgb[i] - spoiled.rgb[i]) > 3;
  CHECK(changed < 4000);
  for (int y = 100; y < 180; ++y)
    for (int x = 0; x < 960; ++x)
      CHECK_UNARY(clean.rgb[static_cast<std::size_t>(y * 960 + x)] ==
                  spoiled.rgb[static_cast<std::size_t>(y * 960 + x)]);
}

TEST_CASE("both GL backends draw the same") {
  try {
    Raster probe(GlBackend::egl);
  } catch (const Error& error) {
    MESSAGE("EGL is not there: ", error.what());
    return;
  }
  const Stage a(320, 180, Theme::light, GlBackend::osmesa),
      b(320, 180, Theme::light, GlBackend::egl);
  int covered = 0, different = 0;
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 320; ++x) {
      const auto i = static_cast<std::size_t>(y * a.picture.stride + x);
      covered += a.picture.depth[i] < 1;
      different += (a.picture.depth[i] < 1) != (b.picture.depth[i] < 1);
    }
  CHECK(covered > 5000);
  CHECK(different < covered / 1000);
  const Difference d = compare(light(a), light(b));
  CHECK(d.share < 1e-3);
}

TEST_CASE("a sphere covers its projected area") {
  // A cone of half angle asin(r / d) around the axis: area pi (tan of it)^2 of the picture plane.
  const SurfaceMesh sphere = sphere_surface(Vec3(0, 0, 0), 0.5, 200);
  CornerMesh mesh;
  append_surface(sphere, {}, mesh);
  Bounds3f bounds;
  bounds.add(Vec3f(-0.5f, -0.5f, -0.5f));
  bounds.add(Vec3f(0.5f, 0.5f, 0.5f));
  Camera camera;
  camera.eye = Vec3(3, 0, 0);
  camera.target = Vec3(0, 0, 0);
  camera.fov = 30;
  const PerspectiveView view = make_view(camera, 800, 600, bounds);
  Raster raster(GlBackend::automatic);
  raster.upload(mesh, {}, 0);
  GBuffer picture;
  raster.draw(view, picture);
  const double tangent = std::tan(std::asin(0.5 / 3)) / std::tan(15 * std::numbers::pi / 180);
  const double exact = std::numbers::pi * tangent * tangent * 300 * 300;
  double covered = 0;
  for (int y = 0; y < 600; ++y)
    for (int x = 0; x < 800; ++x)
      covered += picture.depth[static_cast<std::size_t>(y * picture.stride + x)] < 1;
  CHECK(covered == doctest::Approx(exact).epsilon(0.01));

  // A particle of the same size: the impostor is a disc of radius r / d in the picture plane.
  raster.upload({}, {{{0, 0, 0}, 0.5f}}, 0.2f);
  raster.draw(view, picture);
  const double disc = 0.2 / 3 / std::tan(15 * std::numbers::pi / 180) * 300;
  covered = 0;
  for (int y = 0; y < 600; ++y)
    for (int x = 0; x < 800; ++x) {
      const auto i = static_cast<std::size_t>(y * picture.stride + x);
      if (picture.depth[i] >= 1) continue;
      covered += 1;
      CHECK_UNARY((picture.surface[i] >> 22 & 3) == 3);
    }
  CHECK(covered == doctest::Approx(std::numbers::pi * disc * disc).epsilon(0.01));
}

TEST_CASE("crease corners of a box face their own sides") {
  const std::vector<Prop> grips = bar_grips();
  CornerMesh mesh;
  append_prop(grips[0], mesh);
  CHECK(mesh.vertices.size() == 24);  // 8 corners, three sides each
  CHECK(mesh.indices.size() == 36);
}

TEST_CASE("crack faces and skin share no corner") {
  const SurfaceMesh bar = torn_bar(4000);
  CornerMesh mesh;
  append_surface(bar, bar.damage, mesh);
  for (std::size_t t = 0; t < bar.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t kind = mesh.vertices[mesh.indices[3 * t + k]].normal_kind >> 30;
      CHECK_UNARY(kind == (bar.interior[t] ? 1u : 0u));
    }
}

TEST_CASE(
    "the floor is open far away, dim under a thing that lies on it, and brighter the higher the "
    "thing hangs") {
  double last = 0;
  for (const float height : {0.0f, 0.2f, 0.6f, 1.5f}) {
    Prop slab;
    for (int i = 0; i < 4; ++i)
      slab.x.push_back(Vec3f(i & 1 ? 1.0f : -1.0f, height, i & 2 ? 1.0f : -1.0f));
    slab.triangles = {{0, 1, 2}, {1, 3, 2}};
    CornerMesh mesh;
    append_prop(slab, mesh);
    Bounds3f bounds;
    for (const Vec3f& x : slab.x) bounds.add(x);
    const GroundMap map = make_ground_map(mesh, {}, 0, 0, bounds);
    const float center = map.open[128 * 256 + 128];
    CHECK(map.open[0] > 0.97f);
    CHECK(center > last);
    last = center;
    if (height == 0) CHECK(center < 0.3f);
  }
}
