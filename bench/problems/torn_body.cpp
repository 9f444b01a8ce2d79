// Grips, their work, and the fracture mesh of what they leave.
#include "bench/problems/torn_body.h"

#include "engine/core/random.h"
#include "engine/fracture/fracture_mesh.h"
#include "engine/mesh/build_model.h"
#include "engine/scene/motion.h"
#include "engine/scene/scene_reader.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>

namespace rend {

namespace {

Real opening(const SceneDesc& scene, Real time) {
  return (pose_at(scene.colliders[1].motion, time).position -
          pose_at(scene.colliders[0].motion, time).position)
      .norm();
}

Real crack_area(const SurfaceMesh& mesh) {
  Real area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.interior[t]) continue;
    const auto at = [&](std::size_t corner) {
      return mesh.rest[static_cast<std::size_t>(mesh.triangles[t][corner])];
    };
    area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
  }
  return 0.5 * area;
}

}  // namespace

Torn tear(const SceneDesc& scene, const Model& model, bool with_fracture_mesh) {
  Trial trial(scene, model);
  std::optional<FractureMesh> mesh;
  if (with_fracture_mesh) mesh.emplace(scene, model);
  const YieldSurface& surface = scene.materials[0].yield_surface;
  Torn out;
  out.modulus = surface.value[*find_parameter(surface.type, "softening")];
  Snapshot snapshot;
  Real work = 0, way = opening(scene, 0);
  for (int frame = 1; frame <= scene.frames; ++frame) {
    const FrameReport report = trial.advance(1 / scene.frame_rate);
    if (report.status != Status::ok) break;
    const Real now = opening(scene, trial->time());
    out.peak_force = std::max(out.peak_force, (report.external_work - work) / (now - way));
    work = report.external_work;
    way = now;
    out.dissipated = report.dissipated_energy;
    out.damaged = report.damaged;
    if (!mesh) continue;
    snapshot = trial->snapshot();
    snapshot.frame = frame;
    mesh->update(snapshot);
  }
  if (mesh) {
    out.pieces = mesh->report().pieces;
    out.crack_area = crack_area(mesh->surface(snapshot));
  }
  out.cost = trial.cost();
  return out;
}

Torn tear_notched_bar(const std::filesystem::path& scenes, const NotchRun& run) {
  SceneDesc scene =
      read_scene(scenes / "e11_17k_dx_0_108.json", {},
                 {{"/seed", std::to_string(run.seed)},
                  {"/gravity", "[0, 0, 0]"},
                  {"/grid/dx", fmt::format("{}", run.dx)},
                  {"/bodies/0/force", run.mesh_force ? "mesh" : "particle"},
                  {"/materials/clay/strength_field/modulus", "0"},
                  {"/materials/clay/yield_surface",
                   fmt::format(R"({{"type": "rankine", "tau_c": 8000, {}}})", run.softening)}});
  const Mat3 R = rotation_from_degrees(Vec3(0, 0, run.turn));
  Random random(4, static_cast<std::uint64_t>(run.shift));
  Vec3 shift = Vec3::Zero();
  if (run.shift > 0)
    for (Real& s : shift) s = run.dx * random.next();
  const auto place = [&](Vec3& position, Vec3& rotation) {
    position = R * position + shift;
    rotation[2] += run.turn;
  };
  for (BodyDesc& body : scene.bodies) place(body.position, body.rotation);
  for (ColliderDesc& grip : scene.colliders)
    for (Keyframe& key : grip.motion) place(key.position, key.rotation);
  return tear(scene, build_model(scene), true);
}

}  // namespace rend
