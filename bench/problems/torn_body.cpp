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

// Cells across the bar, the same at every dx, so that only the length of a cell changes.
constexpr Real kAcross = 3;

constexpr Real kBarSpeed = 0.075;  // of each grip [m/s]

std::string bar_text(const BarRun& run, Real along, Real across) {
  const auto grip = [&](int side) {
    return fmt::format(
        R"({{"shape": {{"type": "box", "size": [2, 4, 4]}}, "contact": "stick", "motion": [
            {{"time": 0, "position": [{}, 0, 0]}}, {{"time": 8, "position": [{}, 0, 0]}}]}})",
        4 * side + along, (4 + 8 * kBarSpeed) * side + along);
  };
  return fmt::format(
      R"({{"name": "bar", "frame_rate": 10, "frames": 80, "gravity": [0, 0, 0],
          "grid": {{"dx": {}}}, "solver": {{"kernel": "{}"}},
          "materials": {{"m": {{"density": 1, "youngs_modulus": 100, "poisson_ratio": 0.3,
            "yield_surface": {{"type": "rankine", "tau_c": 5, {}}},
            "damage": {{"type": "granular", "threshold": 0.02}}}}}},
          "bodies": [{{"shape": {{"type": "box", "size": [8, {}, {}]}}, "material": "m",
            "force": "{}", "particles_per_cell": {},
            "position": [{}, {}, {}]}}],
          "colliders": [{}, {}]}})",
      run.dx, run.solver.kernel == Kernel::cubic ? "cubic" : "quadratic", run.softening,
      kAcross * run.dx, kAcross * run.dx, run.mesh_force ? "mesh" : "particle",
      run.particles_per_cell, along, across, -across, grip(-1), grip(1));
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

Torn tear_bar(const BarRun& run) {
  Random random(3, static_cast<std::uint64_t>(run.shift));
  const Real along = run.dx * random.next(), across = run.dx * random.next();
  SceneDesc scene = parse_scene(bar_text(run, along, across), "bar", ".");
  scene.solver = run.solver;
  Model model = build_model(scene);
  // The crack starts in the middle, in a zone of the same number of cells at every dx. Matter moves
  // with the grips from the start, so that no wave runs ahead of them.
  model.strength.assign(model.X.size(), 1);
  for (std::size_t p = 0; p < model.X.size(); ++p) {
    const Real x = model.X[p][0] - along;
    if (std::abs(x) < run.dx) model.strength[p] = 0.8f;
    model.velocity[p][0] = kBarSpeed * std::clamp(x / 3, -1.0, 1.0);
  }
  Torn out = tear(scene, model, run.with_fracture_mesh);
  const Real section = std::pow(kAcross * run.dx, 2);
  out.dissipated /= section;
  out.peak_force /= section;
  out.crack_area /= section;
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
