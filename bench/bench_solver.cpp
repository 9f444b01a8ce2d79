// The problem, the three solvers on it, and the table.
#include "bench/bench_solver.h"

#include "bench/instruction_count.h"
#include "bench/solver_problem.h"
#include "bench/textbook_solver.h"
#include "engine/core/parallel.h"
#include "engine/core/stopwatch.h"
#include "engine/mpm/reference_solver.h"
#include "engine/mpm/tile_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <string>

#include <malloc.h>

namespace rend {

namespace {

constexpr Real kFlops = 1500;  // hand count of one particle and step, speed notes of the design

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TextbookProblem textbook_problem(const SceneDesc& scene, const Model& model) {
  const MaterialDesc& material = scene.materials[0];
  const Lame lame = lame_parameters(material.youngs_modulus, material.poisson_ratio);
  TextbookProblem out;
  for (std::size_t p = 0; p < model.X.size(); ++p) {
    out.x.insert(out.x.end(), model.X[p].data(), model.X[p].data() + 3);
    out.v.insert(out.v.end(), model.velocity[p].data(), model.velocity[p].data() + 3);
    for (int a = 0; a < 9; ++a) out.C.push_back(model.velocity_gradient[0](a / 3, a % 3));
  }
  out.volume = model.volume;
  out.mu = lame.mu;
  out.lambda = lame.lambda;
  out.density = material.density;
  out.tau_c = material.yield_surface.value[0];
  out.dt = kBenchTimeStep;
  return out;
}

// Largest differences from the reference, relative to its largest values.
struct Errors {
  Real v = -1, b = -1, tau_c = -1;
};

struct Truth {
  std::vector<Vec3> v;
  std::vector<Mat3> b;
  std::vector<Real> tau_c;

  explicit Truth(const Particles& p) : v(p.v), tau_c(p.tau_c) {
    for (const Mat3& F : p.F) b.push_back(F * F.transpose() - Mat3::Identity());
  }
  template <class Read>
  Errors compare(Read&& read) const {
    Real v_max = 0, b_max = 0, tau_max = 0;
    Errors e{0, 0, 0};
    for (std::size_t i = 0; i < v.size(); ++i) {
      const TileSolver::Point q = read(i);
      e.v = std::max(e.v, (q.v - v[i]).cwiseAbs().maxCoeff());
      e.b = std::max(e.b, (q.strain - b[i]).cwiseAbs().maxCoeff());
      e.tau_c = std::max(e.tau_c, std::abs(q.tau_c - tau_c[i]));
      v_max = std::max(v_max, v[i].cwiseAbs().maxCoeff());
      b_max = std::max(b_max, b[i].cwiseAbs().maxCoeff());
      tau_max = std::max(tau_max, std::abs(tau_c[i]));
    }
    return {e.v / v_max, e.b / b_max, e.tau_c / tau_max};
  }
};

// Errors by solver, instruction set and surface after 100 steps of 14,000 particles.
std::map<std::string, Errors> solver_errors() {
  std::map<std::string, Errors> out;
  const Model model = bench_model(12);
  for (const char* surface : {"von_mises", "rankine"}) {
    SceneDesc scene = bench_scene(surface);
    scene.solver.time_step = 3 * kBenchTimeStep;  // far enough for several re-bins
    ReferenceSolver reference(scene, model);
    reference.advance(100 * scene.solver.time_step);
    const Truth truth(reference.particles());
    out[std::string("reference") + surface] = {0, 0, 0};
    for (const TileKernels* kernels : all_tile_kernels()) {
      TileSolver tile(scene, model, kernels);
      tile.advance(100 * scene.solver.time_step);
      const std::vector<TileSolver::Point> points = tile.points();
      out[std::string("tile") + kernels->name + surface] =
          truth.compare([&](std::size_t i) { return points[i]; });
    }
    if (std::strcmp(surface, "von_mises") != 0 || !textbook_runs_here()) continue;
    TextbookProblem problem = textbook_problem(scene, model);
    problem.dt = scene.solver.time_step;
    TextbookSolver textbook(problem);
    for (int n = 0; n < 100; ++n) textbook.step();
    out["textbookvon_mises"] = truth.compare([&](std::size_t i) {
      TileSolver::Point q;
      double e[6];
      textbook.read(i, q.v.data(), e);
      q.strain << e[0], e[3], e[5], e[3], e[1], e[4], e[5], e[4], e[2];
      q.tau_c = problem.tau_c;
      return q;
    });
  }
  return out;
}

// How far the resident memory of the process grows beyond what it was.
class PeakMemory {
 public:
  PeakMemory() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5;  // the peak starts again from here
    before_ = peak();
  }
  double grown() const { return std::max(0.0, peak() - before_); }

 private:
  static double peak() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("VmHWM:")) return 1024 * std::stod(line.substr(6));
    return 0;
  }
  double before_;
};

struct Timing {
  double cpu, wall;
};
template <class F>
Timing time_of(F&& run) {
  const double cpu = cpu_seconds(), wall = wall_seconds();
  run();
  return {cpu_seconds() - cpu, wall_seconds() - wall};
}

constexpr int kRepeats = 3;

void set_times(SolverBenchRow& row, const Timing& timing) {
  const double per = 1e9 / (static_cast<double>(row.steps) * row.particles);
  row.cpu_ns = timing.cpu * per;
  row.wall_ns = timing.wall * per;
}

// The shortest of a few runs: the others had company.
template <class F>
Timing best_time_of(F&& run) {
  Timing best = time_of(run);
  for (int r = 1; r < kRepeats; ++r) {
    const Timing next = time_of(run);
    if (next.cpu < best.cpu) best = next;
  }
  return best;
}

SolverBenchRow run_textbook(const SceneDesc& scene, const Model& model, Index steps) {
  SolverBenchRow row;
  row.solver = "textbook";
  row.particles = model.particle_count();
  row.steps = steps;
  TextbookSolver solver(textbook_problem(scene, model));
  solver.step();
  set_times(row, best_time_of([&] {
              for (Index n = 0; n < steps; ++n) solver.step();
            }));
  row.bytes = solver.bytes_per_particle();
  return row;
}

SolverBenchRow run_reference(const SceneDesc& scene, const Model& model, Index steps) {
  SolverBenchRow row;
  row.solver = "reference";
  row.particles = model.particle_count();
  row.steps = steps;
  ReferenceSolver solver(scene, model);
  set_times(row, time_of([&] { solver.advance(steps * kBenchTimeStep); }));
  row.bytes = solver.bytes_per_particle();
  return row;
}

}  // namespace

SolverBenchRow run_tile(const SceneDesc& scene, const Model& model, const TileKernels* kernels,
                        Index steps) {
  SolverBenchRow row;
  row.solver = "tile";
  row.simd = kernels->name;
  row.particles = model.particle_count();
  row.steps = steps;
  PeakMemory memory;
  TileSolver solver(scene, model, kernels);
  solver.advance(3 * kBenchTimeStep);
  for (int r = 0; r < kRepeats; ++r) {
    const TileTimes before = solver.times();
    const Timing timing = time_of([&] { solver.advance(steps * kBenchTimeStep); });
    const TileTimes after = solver.times();
    row.rebins = after.rebins;
    const double per = 1e9 / (static_cast<double>(steps) * row.particles);
    if (r > 0 && timing.cpu * per >= row.cpu_ns) continue;
    set_times(row, timing);
    row.particles_ns = (after.particles - before.particles) * per;
    row.elements_ns = (after.elements - before.elements) * per;
    row.grid_ns = (after.grid - before.grid) * per;
    row.rebin_ns = (after.rebin - before.rebin) * per;
    row.frame_ns = row.cpu_ns - row.particles_ns - row.elements_ns - row.grid_ns - row.rebin_ns;
  }
  row.bytes = solver.bytes_per_particle();
  row.peak_bytes = memory.grown() / row.particles;
  return row;
}

double tile_instructions(const SceneDesc& scene, const Model& model, const TileKernels* kernels) {
  const double count = count_instructions([&](const std::function<void()>& mark) {
    TileSolver solver(scene, model, kernels);
    int step = 0;
    solver.advance(6 * kBenchTimeStep, [&] {
      if (++step == 3 || step == 4) mark();
      return true;
    });
  });
  return count < 0 ? -1 : count / model.particle_count();
}

namespace {

double textbook_instructions(const SceneDesc& scene, const Model& model) {
  const double count = count_instructions([&](const std::function<void()>& mark) {
    TextbookSolver solver(textbook_problem(scene, model));
    for (int n = 0; n < 3; ++n) solver.step();
    mark();
    solver.step();
    mark();
  });
  return count < 0 ? -1 : count / model.particle_count();
}

}  // namespace

std::vector<SolverBenchRow> bench_solver(bool quick, std::FILE* progress) {
  const auto tell = [&](const std::string& what) {
    if (progress) fmt::print(progress, "{}\n", what);
  };
  tell("errors after 100 steps");
  const std::map<std::string, Errors> errors = solver_errors();
  set_thread_count(1);
  std::map<std::string, double> instructions;
  if (!quick) {
    tell("instructions of one step, counted one by one");
    const Model small = bench_model(6);
    for (const TileKernels* kernels : all_tile_kernels())
      if (std::strcmp(kernels->name, "sse4") != 0)
        instructions[std::string("tile") + kernels->name + "von_mises"] =
            tile_instructions(bench_scene("von_mises"), small, kernels);
    if (textbook_runs_here())
      instructions["textbookvon_mises"] =
          textbook_instructions(bench_scene("von_mises"), bench_model(3));
  }
  std::vector<SolverBenchRow> rows;
  const std::vector<int> threads = quick ? std::vector<int>{1} : std::vector<int>{1, 2};
  for (const int cells : quick ? std::vector<int>{12} : std::vector<int>{23, 50}) {
    const Model model = bench_model(cells);
    const Index tile_steps = quick ? 40 : 100;
    const Index slow_steps = cells > 30 ? 2 : 4;
    tell(fmt::format("{} particles", model.particle_count()));
    const double peak = textbook_runs_here() ? fma_flops_per_second(0.3) : 0;
    Real textbook_ns = 0;
    const auto add = [&](SolverBenchRow row, const char* surface, int thread_count) {
      row.surface = surface;
      row.threads = thread_count;
      if (row.solver == "textbook") textbook_ns = row.cpu_ns;
      row.ratio_to_textbook = textbook_ns / row.cpu_ns;
      row.fma_share = peak > 0 ? kFlops / (1e-9 * row.cpu_ns) / peak : 0;
      const auto found = errors.find(row.solver + row.simd + surface);
      const Errors e = found == errors.end() ? Errors{} : found->second;
      row.error_v = e.v;
      row.error_b = e.b;
      row.error_tau_c = e.tau_c;
      const auto counted = instructions.find(row.solver + row.simd + surface);
      if (counted != instructions.end()) row.instructions = counted->second;
      for (const SolverBenchRow& one : rows)
        if (one.threads == 1 && one.solver == row.solver && one.simd == row.simd &&
            one.surface == row.surface && one.particles == row.particles)
          row.speedup = one.wall_ns / row.wall_ns;
      rows.push_back(row);
      tell(fmt::format("  {} {} {} {} threads: {:.1f} ns", row.solver, row.simd, surface,
                       thread_count, row.cpu_ns));
    };
    const SceneDesc von_mises = bench_scene("von_mises"), rankine = bench_scene("rankine");
    set_thread_count(1);
    if (textbook_runs_here()) add(run_textbook(von_mises, model, slow_steps), "von_mises", 1);
    for (const int t : threads) {
      set_thread_count(t);
      add(run_reference(von_mises, model, slow_steps), "von_mises", t);
      for (const TileKernels* kernels : all_tile_kernels()) {
        add(run_tile(von_mises, model, kernels, tile_steps), "von_mises", t);
        add(run_tile(rankine, model, kernels, tile_steps), "rankine", t);
      }
    }
    set_thread_count(0);
  }
  return rows;
}

void print_solver_bench(const std::vector<SolverBenchRow>& rows, std::FILE* out, std::FILE* csv) {
  const auto number = [](Real value, int digits) {
    return value < 0 ? std::string("n/a") : fmt::format("{:.{}f}", value, digits);
  };
  fmt::print(out,
             "{:<10}{:<8}{:<10}{:>3}{:>9} {:>8}{:>8}{:>7}{:>7}{:>8}{:>7}{:>8}{:>7}{:>7}{:>7}{:>7}"
             "{:>7}{:>7} {:>9}{:>9}{:>9}\n",
             "solver", "simd", "surface", "thr", "particles", "cpu ns", "wall ns", "ratio",
             "faster", "instr", "fma %", "parts", "grid", "rebin", "frame", "rebins", "bytes",
             "peak", "err v", "err b", "err tau_c");
  for (const SolverBenchRow& r : rows)
    fmt::print(out,
               "{:<10}{:<8}{:<10}{:>3}{:>9} {:>8.1f}{:>8.1f}{:>7.1f}{:>7.2f}{:>8}{:>7.1f}{:>8.1f}"
               "{:>7.2f}{:>7.2f}{:>7.2f}{:>7}{:>7.0f}{:>7} {:>9.1e}{:>9.1e}{:>9.1e}\n",
               r.solver, r.simd, r.surface, r.threads, r.particles, r.cpu_ns, r.wall_ns,
               r.ratio_to_textbook, r.speedup, number(r.instructions, 0), 100 * r.fma_share,
               r.particles_ns, r.grid_ns, r.rebin_ns, r.frame_ns, r.rebins, r.bytes,
               number(r.peak_bytes, 0), r.error_v, r.error_b, r.error_tau_c);
  fmt::print(
      out,
      "ratio: CPU time of the textbook solver of this run over this one's; faster: wall time "
      "of one thread over this; instr: instructions per particle and step; fma %: {:.0f} "
      "flops over the FMA peak of this run; peak: resident bytes per particle with the copy "
      "of the last good frame.\n",
      kFlops);
  if (!csv) return;
  fmt::print(csv,
             "solver,simd,precision,yield_surface,threads,particles,steps,rebins,"
             "ns_per_particle_step,wall_ns_per_particle_step,ratio_to_textbook,speedup,"
             "instructions_per_particle_step,fma_share,particles_ns,grid_ns,rebin_ns,frame_ns,"
             "bytes_per_particle,peak_bytes_per_particle,error_v,error_b,error_tau_c\n");
  for (const SolverBenchRow& r : rows)
    fmt::print(csv,
               "{},{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{},{:.6g},{:.6g},{:.6g},{:.6g},"
               "{:.6g},{:.6g},{},{:.6g},{:.6g},{:.6g}\n",
               r.solver, r.simd, r.solver == "tile" ? "float" : "double", r.surface, r.threads,
               r.particles, r.steps, r.rebins, r.cpu_ns, r.wall_ns, r.ratio_to_textbook, r.speedup,
               number(r.instructions, 1), r.fma_share, r.particles_ns, r.grid_ns, r.rebin_ns,
               r.frame_ns, r.bytes, number(r.peak_bytes, 1), r.error_v, r.error_b, r.error_tau_c);
}

}  // namespace rend
