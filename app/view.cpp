// From a frame and a viewer's wishes to a draw list.
#include "app/view.h"

#include "app/prop_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rend {

namespace {

/// Fields that exist both on surface vertices and on particles, in either order.
struct Fields {
  const std::vector<float>*damage, *stress, *nearness;
  std::vector<float> speed;
};

/// A legend end that is easy to read: 1, 2 or 5 times a power of ten, not below `value`.
float round_up(float value) {
  if (!(value > 0)) return 1;
  const float power = std::pow(10.0f, std::floor(std::log10(value)));
  for (float factor : {1.0f, 2.0f, 5.0f})
    if (value <= factor * power) return factor * power;
  return 10 * power;
}

float percentile(std::vector<float> values, double share) {
  if (values.empty()) return 0;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

struct Unit {
  float scale;
  const char* name;
};

Unit pressure_unit(float pascal) {
  if (pascal >= 1e9f) return {1e-9f, "GPa"};
  if (pascal >= 1e6f) return {1e-6f, "MPa"};
  if (pascal >= 1e3f) return {1e-3f, "kPa"};
  return {1, "Pa"};
}

void scale_all(std::vector<float>& values, float factor) {
  for (float& v : values) v *= factor;
}

Coloring make_coloring(const std::string& color_by, Fields fields) {
  Coloring coloring;
  if (color_by == "damage" || color_by == "yielded") {
    coloring.map = ColorMap::damage;
    coloring.value = *fields.damage;
    coloring.caption = "Damage";
  } else if (color_by == "stress") {
    coloring.map = ColorMap::cividis;
    coloring.value = *fields.stress;
    const Unit unit = pressure_unit(percentile(coloring.value, 0.98));
    scale_all(coloring.value, unit.scale);
    coloring.high = round_up(percentile(coloring.value, 0.98));
    coloring.caption = fmt::format("Largest stress, {}", unit.name);
  } else if (color_by == "speed") {
    coloring.map = ColorMap::cividis;
    coloring.value = std::move(fields.speed);
    coloring.high = round_up(percentile(coloring.value, 0.98));
    coloring.caption = "Speed, m/s";
  } else if (color_by == "threshold") {
    coloring.map = ColorMap::cividis;
    coloring.value = *fields.nearness;
    coloring.caption = "Share of break threshold";
  }
  return coloring;
}

}  // namespace

std::string View::key() const {
  return fmt::format("{}x{} {} {} {} {} {} {} {} {} {} {} {} {} {}", width, height, color_by, particles,
                     static_cast<int>(theme), accumulate, camera.eye.x(), camera.eye.y(), camera.eye.z(),
                     camera.target.x(), camera.target.y(), camera.target.z(), camera.fov, camera.up.y(), legend);
}

View default_view(const SceneDesc& scene) {
  View view;
  view.camera = {scene.camera.eye, scene.camera.target, Vec3::UnitY(), scene.camera.fov};
  view.color_by = scene.render.color_by;
  view.particles = scene.render.particles;
  return view;
}

const std::vector<std::string>& color_names() {
  static const std::vector<std::string> names = {"damage", "stress", "speed", "threshold", "piece", "yielded", "none"};
  return names;
}

Stage make_stage(const SceneDesc& scene, const Model& model) {
  Stage stage{scene, 0, 0, 1};
  for (Real h : model.spacing) stage.spacing = std::max(stage.spacing, h);
  Vec3 low = Vec3::Constant(std::numeric_limits<Real>::infinity()), high = -low;
  for (const Vec3& x : model.X) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  if (!model.X.empty()) stage.size = (high - low).norm();
  if (scene.render.floor) {
    stage.floor = *scene.render.floor;
    return stage;
  }
  for (const ColliderDesc& collider : scene.colliders)
    if (const auto* plane = std::get_if<PlaneDesc>(&collider.shape); plane && plane->normal.y() > 0.99) {
      stage.floor = collider.motion.front().position.y();
      return stage;
    }
  stage.floor = model.X.empty() ? 0 : low.y() - 2 * stage.spacing;
  return stage;
}

Real particle_radius(const Stage& stage) { return 0.55 * stage.spacing; }

Drawing make_drawing(const Stage& stage, const Frame& frame, const View& view) {
  const Snapshot& snapshot = *frame.snapshot;
  Drawing drawing;
  DrawList& list = drawing.list;
  list.theme = view.theme;
  list.floor = static_cast<float>(stage.floor);
  for (const ColliderDesc& collider : stage.scene.colliders)
    if (auto prop = make_prop(collider, snapshot.time)) list.props.push_back(std::move(*prop));
  if (view.particles) {
    auto points = std::make_shared<PointCloud>();
    points->radius = static_cast<float>(particle_radius(stage));
    points->x.reserve(snapshot.x.size());
    for (const Vec3& x : snapshot.x) points->x.push_back(x.cast<float>());
    drawing.points = std::move(points);
    list.points = drawing.points.get();
    static const std::vector<float> untested;
    const std::vector<float>& nearness = frame.nearness ? *frame.nearness : untested;
    std::vector<float> speed;
    if (view.color_by == "speed")
      for (const Vec3f& v : snapshot.v) speed.push_back(v.norm());
    list.coloring = make_coloring(view.color_by, {&snapshot.damage, &snapshot.stress, &nearness, std::move(speed)});
    if (view.color_by == "yielded") {
      list.coloring.value.assign(snapshot.yielded.begin(), snapshot.yielded.end());
      list.coloring.caption = "Yielded";
    }
  } else {
    drawing.surface = frame.surface;
    list.surface = drawing.surface.get();
    const SurfaceMesh& surface = *frame.surface;
    list.coloring = make_coloring(view.color_by, {&surface.damage, &surface.stress, &surface.nearness, surface.speed});
    if (view.color_by == "piece") {
      list.coloring.map = ColorMap::pieces;
      list.coloring.value.assign(surface.piece.begin(), surface.piece.end());
    }
  }
  return drawing;
}

}  // namespace rend
