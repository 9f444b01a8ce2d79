// Runs of the bar, and its shape.
#include "bench/problems/taylor_bar.h"

#include "engine/mesh/build_model.h"
#include "engine/scene/scene_reader.h"

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

// Radius at the height of some particles: their distance from the axis runs on to the rest radius
// of the bar.
Real radius_of(const Model& model, const Matter& now, Real low, Real high) {
  Real n = 0, sr = 0, sR = 0, srR = 0, sRR = 0;
  for (std::size_t p = 0; p < now.x.size(); ++p) {
    const Real Y = model.X[p][1], R = std::hypot(model.X[p][0], model.X[p][2]);
    if (Y < low || Y > high || R < 0.8 * kTaylorRadius) continue;
    const Real r = std::hypot(now.x[p][0], now.x[p][2]);
    n += 1;
    sr += r;
    sR += R;
    srR += r * R;
    sRR += R * R;
  }
  const Real slope = (n * srR - sr * sR) / (n * sRR - sR * sR);
  return sr / n + slope * (kTaylorRadius - sR / n);
}

}  // namespace

TaylorShape strike_wall(const std::filesystem::path& scenes, Real dx, const SolverDesc& solver) {
  SceneDesc scene = read_scene(scenes / "taylor_bar.json");
  scene.grid.dx = dx;
  scene.solver = solver;
  const Model model = build_model(scene);
  Trial trial(scene, model);
  FrameReport report;
  TaylorShape out;
  for (int frame = 0; frame < scene.frames; frame += 10) {
    report = trial.advance(10 / scene.frame_rate);
    out.cost = trial.cost();
    if (report.status != Status::ok) return out;
  }
  const Matter now = trial.matter();
  const Real spacing = dx / 2;
  Real top = -1;
  for (std::size_t p = 0; p < now.x.size(); ++p)
    if (model.X[p][1] > kTaylorHeight - spacing) top = std::max(top, now.x[p][1]);
  out.length = top + 0.5 * spacing;
  out.foot = radius_of(model, now, 0, 1.01 * spacing);
  out.kinetic = report.kinetic_energy;
  out.dissipated =
      report.dissipated_energy / (0.5 * report.mass * scene.bodies[0].velocity.squaredNorm());
  return out;
}

}  // namespace rend
