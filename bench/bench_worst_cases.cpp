// Scenes and timing of the worst cases.
#include "bench/bench_worst_cases.h"

#include "engine/core/parallel.h"
#include "engine/core/random.h"
#include "engine/core/stopwatch.h"
#include "engine/mpm/tile_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

namespace rend {

namespace {

constexpr Real kTimeStep = 1.7e-3;  // [s]
constexpr Index kSteps = 40;

// Particles of an eighth of a cell, added one by one.
class Cloud {
 public:
  Cloud() { model_.velocity_gradient.push_back(Mat3::Zero()); }

  Real noise() { return random_.next() - 0.5; }
  void add(const Vec3& x, const Vec3& v) {
    model_.X.push_back(x);
    model_.velocity.push_back(v);
    model_.volume.push_back(0.125);
    model_.body.push_back(0);
    model_.material.push_back(0);
  }
  // cells^3 cells of 8 jittered particles from `low` on, stretched and sheared, flying at `drift`.
  void add_box(const Vec3& low, int cells, const Vec3& drift) {
    const Real half = 0.5 * cells;
    Mat3 L;
    L << 1, -0.5, 0.2, 0.5, -0.6, 0.1, 0.3, 0, -0.5;
    for (int i = 0; i < 2 * cells; ++i)
      for (int j = 0; j < 2 * cells; ++j)
        for (int k = 0; k < 2 * cells; ++k) {
          const Vec3 jitter(noise(), noise(), noise());
          const Vec3 x = low + 0.5 * (Vec3(i + 0.5, j + 0.5, k + 0.5) + 0.6 * jitter);
          add(x, drift + 6 / half * L * (x - low - Vec3::Constant(half)));
        }
  }
  // Clumps of side^3 particles on a jittered lattice of this spacing, flying apart, or with `speed`
  // [cells/s] along every axis to either side.
  void add_clumps(const Vec3& low, int edge, int spacing, int side, Real speed = 0) {
    const int count = edge / spacing;
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < count; ++j)
        for (int k = 0; k < count; ++k) {
          const Vec3 jitter(noise(), noise(), noise());
          const Vec3 at = spacing * (Vec3(i + 0.5, j + 0.5, k + 0.5) + 0.5 * jitter);
          Vec3 v = 2 * (at - Vec3::Constant(0.5 * edge)) / (0.5 * edge);
          if (speed > 0) v = 2 * speed * Vec3(noise(), noise(), noise());
          for (int a = 0; a < side; ++a)
            for (int b = 0; b < side; ++b)
              for (int c = 0; c < side; ++c)
                add(low + at + 0.5 * (Vec3(a, b, c) + 0.3 * Vec3(noise(), noise(), noise())), v);
        }
  }
  Model take() { return std::move(model_); }

 private:
  Model model_;
  Random random_{7, 7};
};

Model made(const std::function<void(Cloud&)>& fill) {
  Cloud cloud;
  fill(cloud);
  return cloud.take();
}

WorstCaseRow measure(const std::string& name, const Model& model, int rounds) {
  SceneDesc scene;
  scene.grid.dx = 1;
  scene.gravity.setZero();
  scene.solver.time_step = kTimeStep;
  MaterialDesc material;
  material.density = 1;
  material.youngs_modulus = 1e4;
  material.yield_surface.type = find_yield_surface("von_mises").value();
  material.yield_surface.value[0] = 154;
  scene.materials.push_back(material);
  TileSolver solver(scene, model);
  solver.advance(3 * kTimeStep);
  WorstCaseRow row;
  row.scene = name;
  row.particles = model.particle_count();
  for (int r = 0; r < rounds; ++r) {
    const Real per = 1e9 / (static_cast<Real>(kSteps) * row.particles);
    const TileTimes before = solver.times();
    const Real begin = cpu_seconds();
    solver.advance(kSteps * kTimeStep);
    const Real ns = per * (cpu_seconds() - begin);
    if (r > 0 && ns >= row.cpu_ns) continue;
    const TileTimes after = solver.times();
    row.cpu_ns = ns;
    row.particles_ns = per * (after.particles - before.particles);
    row.grid_ns = per * (after.grid - before.grid);
    row.islands_ns = per * (after.islands - before.islands);
    row.legs_ns = per * (after.legs - before.legs);
    row.rebin_ns = per * (after.rebin - before.rebin);
  }
  row.rebins = solver.times().rebins;
  return row;
}

}  // namespace

std::vector<WorstCaseRow> bench_worst_cases(bool quick) {
  if (!tile_kernels()) return {};
  const Vec3 here(12, 12, 12), away(60, 12, 12);
  const std::vector<std::pair<std::string, std::function<void(Cloud&)>>> scenes = {
      {"dense box", [&](Cloud& c) { c.add_box(here, 20, Vec3::Zero()); }},
      {"dense box crossing the domain", [&](Cloud& c) { c.add_box(here, 20, Vec3(90, 40, -60)); }},
      {"sheet of one layer",
       [&](Cloud& c) {
         for (int i = 0; i < 256; ++i)
           for (int j = 0; j < 256; ++j)
             c.add(here + 0.5 * Vec3(i, j, 0), Vec3(c.noise(), c.noise(), c.noise()));
       }},
      {"1 particle per cell", [&](Cloud& c) { c.add_clumps(here, 40, 1, 1); }},
      {"isolated debris, 12 cells apart", [&](Cloud& c) { c.add_clumps(here, 168, 12, 1); }},
      {"isolated debris, 8 cells apart", [&](Cloud& c) { c.add_clumps(here, 112, 8, 1); }},
      {"dense box and 5 % isolated debris",
       [&](Cloud& c) {
         c.add_box(here, 20, Vec3::Zero());
         c.add_clumps(away, 180, 12, 1);
       }},
      {"debris 4 cells apart", [&](Cloud& c) { c.add_clumps(here, 96, 4, 1); }},
      {"the same, fast to and fro", [&](Cloud& c) { c.add_clumps(here, 96, 4, 1, 10); }},
      {"1 particle per 27 cells", [&](Cloud& c) { c.add_clumps(here, 81, 3, 1); }},
      {"1 particle per 8 cells", [&](Cloud& c) { c.add_clumps(here, 64, 2, 1); }},
      {"clumps of 8 every 6 cells", [&](Cloud& c) { c.add_clumps(here, 96, 6, 2); }},
      {"the same, fast to and fro", [&](Cloud& c) { c.add_clumps(here, 96, 6, 2, 10); }},
      {"clumps of 64 every 8 cells", [&](Cloud& c) { c.add_clumps(here, 80, 8, 4); }},
  };
  set_thread_count(1);
  std::vector<WorstCaseRow> rows;
  for (const auto& [name, fill] : scenes) {
    rows.push_back(measure(name, made(fill), quick ? 1 : 3));
    rows.back().ratio_to_dense = rows.back().cpu_ns / rows.front().cpu_ns;
  }
  set_thread_count(0);
  return rows;
}

void print_worst_cases(const std::vector<WorstCaseRow>& rows, std::FILE* out) {
  if (rows.empty()) return;
  fmt::print(out, "\n{:<36}{:>10}{:>8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
             "tile solver, one thread", "particles", "rebins", "cpu ns", "x dense", "parts", "grid",
             "islands", "legs", "rebin");
  for (const WorstCaseRow& row : rows)
    fmt::print(out, "{:<36}{:>10}{:>8}{:>9.1f}{:>9.2f}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}\n",
               row.scene, row.particles, row.rebins, row.cpu_ns, row.ratio_to_dense,
               row.particles_ns, row.grid_ns, row.islands_ns, row.legs_ns, row.rebin_ns);
}

}  // namespace rend
