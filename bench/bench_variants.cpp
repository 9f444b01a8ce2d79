// Scenes of the variants and their tables.
#include "bench/bench_variants.h"

#include "bench/solver_problem.h"
#include "engine/core/parallel.h"
#include "engine/mesh/build_model.h"
#include "engine/mpm/tile_solver.h"

#include <fmt/format.h>

#include <utility>

namespace rend {

namespace {

// A box of vertices with mesh forces, two a cell, that stretches like the others.
std::pair<SceneDesc, Model> mesh_problem(SceneDesc scene, int cells) {
  BodyDesc body;
  body.shape = BoxDesc{Vec3::Constant(cells)};
  body.force = ForceKind::mesh;
  body.particles_per_cell = 2;
  body.position = Vec3::Constant(12 + 0.5 * cells);
  body.velocity_gradient << 1, -0.5, 0.2, 0.5, -0.6, 0.1, 0.3, 0, -0.5;
  body.velocity_gradient *= 12.0 / cells;
  scene.bodies.push_back(body);
  Model model = build_model(scene);
  return {std::move(scene), std::move(model)};
}

SolverVariantRow measured(const std::string& name, const SceneDesc& scene, const Model& model,
                          Index steps, std::FILE* progress) {
  SolverVariantRow out{name, run_tile(scene, model, tile_kernels(), steps), 1};
  if (progress) fmt::print(progress, "  {}: {:.1f} ns\n", name, out.row.cpu_ns);
  return out;
}

void compare_to_first(std::vector<SolverVariantRow>& rows) {
  for (SolverVariantRow& row : rows) row.ratio = row.row.cpu_ns / rows.front().row.cpu_ns;
}

}  // namespace

std::vector<SolverVariantRow> bench_features(bool quick, std::FILE* progress) {
  std::vector<SolverVariantRow> rows;
  if (!tile_kernels()) return rows;
  set_thread_count(1);
  const int cells = quick ? 12 : 23;
  const Index steps = 40;
  const Model model = bench_model(cells);
  const auto add = [&](const std::string& name, const SceneDesc& scene) {
    rows.push_back(measured(name, scene, model, steps, progress));
  };
  add("elastic", bench_scene("elastic"));
  const SceneDesc plain = bench_scene("von_mises");
  add("von Mises", plain);
  SceneDesc scene = plain;
  scene.materials[0].yield_surface.value[1] = 500;
  add("von Mises, softening", scene);
  scene = bench_scene("rankine");
  add("Rankine", scene);
  scene.materials[0].yield_surface.value[1] = 500;
  add("Rankine, softening", scene);
  scene.materials[0].damage.type = DamageType::granular;
  add("Rankine, softening, granular damage", scene);
  Model varied = model;
  varied.strength.assign(varied.X.size(), 1.0f);
  rows.push_back(measured("the same with strength that varies", scene, varied, steps, progress));
  scene = plain;
  scene.gravity = Vec3(0, -9.81, 0);
  add("von Mises, gravity", scene);
  ColliderDesc floor;
  floor.shape = PlaneDesc{};
  floor.contact = Contact::separate;
  floor.motion.push_back({0, Vec3(0, 11, 0), Vec3::Zero()});
  scene.colliders.push_back(floor);
  add("von Mises, gravity, a floor", scene);
  scene = plain;
  scene.solver.transfer = Transfer::rpic;
  add("von Mises, RPIC", scene);
  scene.solver.transfer = Transfer::pic;
  add("von Mises, PIC", scene);
  scene.solver.transfer = Transfer::flip;
  add("von Mises, FLIP", scene);
  const auto [mesh_scene, mesh_model] = mesh_problem(plain, cells);
  rows.push_back(
      measured("mesh forces, 2 vertices per cell", mesh_scene, mesh_model, steps, progress));
  set_thread_count(0);
  compare_to_first(rows);
  return rows;
}

std::vector<SolverVariantRow> bench_sizes(bool quick, std::FILE* progress) {
  std::vector<SolverVariantRow> rows;
  if (!tile_kernels()) return rows;
  set_thread_count(1);
  for (const int cells : quick ? std::vector<int>{11, 23} : std::vector<int>{11, 23, 50, 79}) {
    const Model model = bench_model(cells);
    rows.push_back(measured(fmt::format("{} particles", model.particle_count()),
                            bench_scene("von_mises"), model, cells > 60 ? 20 : 40, progress));
  }
  set_thread_count(0);
  compare_to_first(rows);
  return rows;
}

void print_variants(const char* title, const std::vector<SolverVariantRow>& rows, std::FILE* out) {
  if (rows.empty()) return;
  fmt::print(out, "\n{:<38}{:>10}{:>9}{:>7}{:>8}{:>9}{:>7}{:>7}{:>7}{:>7}{:>7}\n", title,
             "particles", "cpu ns", "ratio", "parts", "elements", "grid", "rebin", "frame", "bytes",
             "peak");
  for (const SolverVariantRow& v : rows) {
    const SolverBenchRow& r = v.row;
    fmt::print(out,
               "{:<38}{:>10}{:>9.1f}{:>7.2f}{:>8.1f}{:>9.1f}{:>7.2f}{:>7.2f}{:>7.2f}{:>7.0f}"
               "{:>7.0f}\n",
               v.name, r.particles, r.cpu_ns, v.ratio, r.particles_ns, r.elements_ns, r.grid_ns,
               r.rebin_ns, r.frame_ns, r.bytes, r.peak_bytes);
  }
}

}  // namespace rend
