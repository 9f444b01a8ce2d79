// Drives a fracture mesh with prescribed motion, so that nothing but the fracture mesh is measured.
#include "bench/bench_fracture.h"

#include "engine/core/parallel.h"
#include "engine/core/random.h"
#include "engine/core/stopwatch.h"
#include "engine/fracture/crack_mesh.h"
#include "engine/fracture/fracture_mesh.h"
#include "engine/mesh/build_model.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rend {

namespace {

constexpr int frames = 50;

SceneDesc box_scene(Index particles) {
  SceneDesc scene;
  scene.materials.emplace_back();
  BodyDesc body;
  body.shape = BoxDesc{Vec3(2, 1, 1)};
  body.particles_per_cell = 8;
  scene.grid.dx = std::cbrt(2 * body.particles_per_cell / particles);
  scene.bodies.push_back(body);
  return scene;
}

// Fragments with wavy borders.
struct Fragments {
  std::vector<Vec3> seeds;
  Fragments(int count, std::uint64_t seed) {
    Random random(seed, 0);
    for (int i = 0; i < count; ++i)
      seeds.push_back({random.next(-1, 1), random.next(-.5, .5), random.next(-.5, .5)});
  }
  int of(const Vec3& X) const {
    const Vec3 wavy =
        X + .02 * Vec3(std::sin(20 * X.y()), std::sin(20 * X.z()), std::sin(20 * X.x()));
    int best = 0;
    for (std::size_t i = 1; i < seeds.size(); ++i)
      if ((wavy - seeds[i]).squaredNorm() < (wavy - seeds[best]).squaredNorm())
        best = static_cast<int>(i);
    return best;
  }
};

Real crossing_share(const Model& model, const std::vector<int>& label) {
  std::size_t crossing = 0, all = 0;
  for (const Tet& t : model.tets)
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j, ++all) crossing += label[t[i]] != label[t[j]];
  return static_cast<Real>(crossing) / static_cast<Real>(all);
}

std::vector<int> labels(const Model& model, const Fragments& fragments) {
  std::vector<int> label(model.X.size());
  std::transform(model.X.begin(), model.X.end(), label.begin(),
                 [&](const Vec3& X) { return fragments.of(X); });
  return label;
}

}  // namespace

FractureBenchRow bench_fracture(Index particles, Real broken_share) {
  const SceneDesc scene = box_scene(particles);
  const Model model = build_model(scene);
  int count = 2;
  while (crossing_share(model, labels(model, Fragments(count, 1))) < broken_share)
    count += 1 + count / 8;
  const Fragments fragments(count, 1);
  const std::vector<int> label = labels(model, fragments);

  const Real start = cpu_seconds();
  FractureMesh mesh(scene, model);
  FractureBenchRow row;
  row.particles = model.particle_count();
  const Real us = 1e6 / static_cast<Real>(row.particles);
  row.setup = us * (cpu_seconds() - start);

  Snapshot now;
  now.x = model.X;
  now.v.assign(model.X.size(), Vec3f::Zero());
  now.damage.assign(model.X.size(), 1);
  now.stress.assign(model.X.size(), 0);
  now.yielded.assign(model.X.size(), 1);
  SurfaceMesh surface;
  std::vector<Real> times;
  const Real opening = 2.5 * model.spacing[0] * std::cbrt(static_cast<Real>(count));
  for (int f = 0; f < frames; ++f) {
    now.frame = f;
    now.time = f / 24.;
    for (std::size_t p = 0; p < model.X.size(); ++p) {
      const Vec3& X = model.X[p];
      const Real front = -1.5 + 4. * f / (frames - 1);
      const Real share = std::clamp((front - X.x()) / 1.5, 0., 1.);
      const Vec3& centre = fragments.seeds[label[p]];
      const Eigen::AngleAxisd turn(.1 * share, centre.normalized());
      now.x[p] = centre + turn * (X - centre) + share * opening * centre;
    }
    const Real begin = cpu_seconds();
    mesh.update(now);
    mesh.surface(now, surface);
    times.push_back(us * (cpu_seconds() - begin));
    if (row.first_crack == 0 && mesh.report().new_broken > 0) row.first_crack = times.back();
    const FractureStages s = mesh.stages();
    row.cut += us * s.cut / frames, row.smooth += us * s.smooth / frames;
    if (f < frames - 5) continue;
    row.test += us * s.test / 5;
    row.pieces += us * s.pieces / 5, row.rotations += us * s.rotations / 5;
    row.positions += us * s.positions / 5, row.indices += us * s.triangles / 5,
        row.normals += us * s.normals / 5;
    row.total += times.back() / 5;
  }
  std::nth_element(times.begin(), times.begin() + frames / 2, times.end());
  row.median = times[frames / 2];
  row.broken_share = static_cast<Real>(mesh.report().broken_edges) /
                     static_cast<Real>(mesh.crack().tables().edge_count());
  row.triangles = static_cast<Real>(surface.triangle_count()) / static_cast<Real>(row.particles);
  row.bytes = mesh.bytes_per_particle();
  return row;
}

void print_fracture_bench(std::span<const Index> sizes, std::FILE* out, std::FILE* csv) {
  // One core: what several cost together depends on what else the machine does.
  set_thread_count(1);
  fmt::print(out,
             "Fracture mesh, CPU us per particle and frame, one thread (mean of the last 5 of {} "
             "frames, when most is broken; cut and smooth, which end before, of all frames)\n"
             "{:>9} {:>7} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} | {:>6} "
             "{:>6} {:>6} {:>6}\n",
             frames, "particles", "broken%", "tri/p", "B/p", "test", "cut", "smooth", "pieces",
             "turn", "place", "index", "normal", "total", "median", "first", "setup");
  if (csv)
    fmt::print(csv,
               "particles,broken_share,triangles,bytes,test,cut,smooth,pieces,rotations,positions,"
               "indices,normals,"
               "total,median,first_crack,setup\n");
  for (Index size : sizes)
    for (Real share : {.02, .05, .2}) {
      const FractureBenchRow r = bench_fracture(size, share);
      fmt::print(out,
                 "{:>9} {:>7.1f} {:>6.2f} {:>6.0f} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} "
                 "{:>6.3f} {:>6.3f} "
                 "{:>6.3f} | {:>6.3f} {:>6.3f} {:>6.3f} {:>6.2f}\n",
                 r.particles, 100 * r.broken_share, r.triangles, r.bytes, r.test, r.cut, r.smooth,
                 r.pieces, r.rotations, r.positions, r.indices, r.normals, r.total, r.median,
                 r.first_crack, r.setup);
      std::fflush(out);
      if (csv)
        fmt::print(csv, "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.particles,
                   r.broken_share, r.triangles, r.bytes, r.test, r.cut, r.smooth, r.pieces,
                   r.rotations, r.positions, r.indices, r.normals, r.total, r.median, r.first_crack,
                   r.setup);
    }
}

}  // namespace rend
