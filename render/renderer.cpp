// One frame: shapes to corners, G-buffer and depth maps by the rasteriser, light, legend.
#include "render/renderer.h"

#include "engine/core/error.h"
#include "engine/core/random.h"
#include "render/corner_mesh.h"
#include "render/legend.h"
#include "render/light.h"
#include "render/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rend {

namespace {

constexpr int kMaxSide = 8192, kMaxPasses = 1024;
constexpr int kLiveMap = 512, kStillMap = 1024;
constexpr int kFullSkyPasses = 32;  ///< fewer directions of the sky would show as separate shadows

float to_unit(const Coloring& coloring, float value) {
  const float span = coloring.high - coloring.low;
  const float t = span > 0 ? (value - coloring.low) / span : 0.0f;
  return t >= 0 ? std::min(t, 1.0f) : 0.0f;  // not a number shows as the low end
}

float piece_value(Index piece) {
  return static_cast<float>(piece <= 0 ? 0 : 1 + (piece - 1) % 255) / 255;
}

std::vector<float> surface_values(const SurfaceMesh& surface, const Coloring& coloring) {
  std::vector<float> values(surface.x.size(), 0.0f);
  if (coloring.map == ColorMap::pieces) {
    for (std::size_t t = 0; t < surface.triangles.size() && t < surface.piece.size(); ++t)
      for (const Index v : surface.triangles[t])
        if (v >= 0 && static_cast<std::size_t>(v) < values.size())
          values[static_cast<std::size_t>(v)] = piece_value(surface.piece[t]);
  } else if (coloring.map != ColorMap::plain) {
    if (coloring.value.size() != values.size())
      throw Error("coloring",
                  fmt::format("{} values for {} vertices", coloring.value.size(), values.size()));
    for (std::size_t v = 0; v < values.size(); ++v)
      values[v] = to_unit(coloring, coloring.value[v]);
  }
  return values;
}

std::vector<PointVertex> point_vertices(const PointCloud& points, const Coloring& coloring) {
  if (!(points.radius > 0) || !std::isfinite(points.radius))
    throw Error("points", fmt::format("radius {}; it must be positive", points.radius));
  const bool colored = coloring.map != ColorMap::plain;
  if (colored && coloring.value.size() != points.x.size())
    throw Error("coloring",
                fmt::format("{} values for {} particles", coloring.value.size(), points.x.size()));
  std::vector<PointVertex> out;
  out.reserve(points.x.size());
  for (std::size_t p = 0; p < points.x.size(); ++p) {
    const Vec3f& x = points.x[p];
    if (!x.allFinite()) continue;
    float value = 0;
    if (coloring.map == ColorMap::pieces)
      value = piece_value(static_cast<Index>(std::clamp(coloring.value[p], 0.0f, 1e9f)));
    else if (colored)
      value = to_unit(coloring, coloring.value[p]);
    out.push_back({{x.x(), x.y(), x.z()}, value});
  }
  return out;
}

/// Low-discrepancy point i of the unit square (Roberts' R2 sequence).
std::array<float, 2> plane_point(int i) {
  const double g = 1.32471795724474602596;
  const double a = 0.5 + i / g, b = 0.5 + i / (g * g);
  return {static_cast<float>(a - std::floor(a)), static_cast<float>(b - std::floor(b))};
}

Vec3f tilted(const Vec3f& axis, float right, float up) {
  const Vec3f seed = std::abs(axis.y()) < 0.9f ? Vec3f(0, 1, 0) : Vec3f(1, 0, 0);
  const Vec3f u = seed.cross(axis).normalized(), v = axis.cross(u);
  return (axis + right * u + up * v).normalized();
}

}  // namespace

struct Renderer::State {
  explicit State(GlBackend backend) : raster(backend) {}

  void draw_key(const Bounds3f& bounds, int size, Look& look) {
    key.size = size;
    raster.draw_depth(make_light_box(look.key_direction, bounds), key);
    // The filter looks at texels up to 2 away, 2.8 across: less of an offset, and faces that the
    // light grazes shadow themselves in stripes.
    const float texel = 2 * key.box.half / static_cast<float>(size);
    look.normal_offset = 2.4f * texel;
    look.depth_bias = 0.5f * texel / (2 * key.box.depth);
  }

  Raster raster;
  GBuffer picture;
  DepthMap key, sky;
  LightPlanes light;
};

Renderer::Renderer(GlBackend backend) : state_(std::make_unique<State>(backend)) {}
Renderer::~Renderer() = default;

std::string Renderer::describe() const {
  return state_->raster.describe() + ", light " + light_lanes();
}

Image Renderer::draw(const DrawList& list, const Camera& camera, const DrawOptions& options) {
  if (options.width < 1 || options.height < 1 || options.width > kMaxSide ||
      options.height > kMaxSide)
    throw Error("picture", fmt::format("{} x {} pixels; allowed are 1 x 1 to {} x {}",
                                       options.width, options.height, kMaxSide, kMaxSide));
  if (options.accumulate < 1 || options.accumulate > kMaxPasses)
    throw Error("picture/accumulate",
                fmt::format("{}; allowed are 1 to {}", options.accumulate, kMaxPasses));
  if (!std::isfinite(list.floor)) throw Error("floor", "the height must be finite");

  CornerMesh mesh;
  std::vector<PointVertex> points;
  float point_radius = 0;
  if (list.surface)
    append_surface(*list.surface, surface_values(*list.surface, list.coloring), mesh);
  for (const Prop& prop : list.props) append_prop(prop, mesh);
  if (list.points) {
    points = point_vertices(*list.points, list.coloring);
    point_radius = list.points->radius;
  }

  Bounds3f bounds;
  for (const MeshVertex& v : mesh.vertices) bounds.add(Vec3f(v.x[0], v.x[1], v.x[2]));
  for (const PointVertex& p : points) bounds.add(Vec3f(p.x[0], p.x[1], p.x[2]));
  if (point_radius > 0 && !bounds.empty()) {
    bounds.box.min().array() -= point_radius;
    bounds.box.max().array() += point_radius;
  }

  PerspectiveView view = make_view(camera, options.width, options.height, bounds);
  // What has flown far out of the picture must not coarsen the shadow of what is in it.
  Bounds3f casters = bounds;
  if (!bounds.empty()) {
    const float reach = 5 * view.half_height * std::max(1.0f, view.tan_x / view.tan_y);
    const Vec3f target = camera.target.cast<float>(), side = Vec3f::Constant(reach);
    casters.box = bounds.box.intersection(Eigen::AlignedBox3f(target - side, target + side));
    if (casters.empty()) casters = bounds;
  }
  Look look = make_look(list, view, casters.center(), casters.radius());

  const GroundMap ground = make_ground_map(mesh, points, point_radius, list.floor, casters);
  State& s = *state_;
  s.raster.upload(mesh, points, point_radius);
  Image image;
  if (options.accumulate == 1) {
    s.draw_key(casters, kLiveMap, look);
    s.raster.draw(view, s.picture);
    image = s.light.light(s.picture, view, s.key, ground, look);
  } else {
    const Look open = look;
    const bool full_sky = options.accumulate >= kFullSkyPasses;
    for (int pass = 0; pass < options.accumulate; ++pass) {
      if (options.keep_on && !options.keep_on()) return {};
      const auto pixel = plane_point(pass), lamp = plane_point(pass + 7919),
                 dome = plane_point(pass + 104729);
      view.shift_x = pixel[0] - 0.5f;
      view.shift_y = pixel[1] - 0.5f;
      look = open;
      const float r = std::sqrt(lamp[0]) * std::tan(open.key_radius);
      const float turn = 2 * std::numbers::pi_v<float> * lamp[1];
      look.key_direction = tilted(open.key_direction, r * std::cos(turn), r * std::sin(turn));
      // The passes together make the area light; each needs only the blur that hides the step to
      // the next.
      look.key_radius = 1.5f * open.key_radius / std::sqrt(static_cast<float>(options.accumulate));
      s.draw_key(casters, kStillMap, look);
      if (full_sky) {
        const float height = dome[0], around = 2 * std::numbers::pi_v<float> * dome[1];
        const float flat = std::sqrt(std::max(0.0f, 1 - height * height));
        look.sky_direction =
            Vec3f(flat * std::cos(around), std::max(height, 0.02f), flat * std::sin(around))
                .normalized();
        s.sky.size = kLiveMap;
        s.raster.draw_depth(make_light_box(look.sky_direction, casters), s.sky);
      }
      s.raster.draw(view, s.picture);
      s.light.add_pass(s.picture, view, s.key, ground, full_sky ? &s.sky : nullptr, look);
    }
    image = s.light.finish_still(open);
  }
  if (!list.coloring.caption.empty()) draw_legend(image, list.coloring, list.theme);
  return image;
}

}  // namespace rend
