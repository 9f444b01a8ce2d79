// Steps of the tile solver with mesh forces: gather, elements, scatter.
#include "engine/core/parallel.h"
#include "engine/core/stopwatch.h"
#include "engine/mpm/tile_solver.h"

#include <algorithm>
#include <cmath>

namespace rend {

// Vertices of elements are runs of their own, even where they share a material with particles.
void TileSolver::add_mesh_materials() {
  if (mesh_.empty()) return;
  const std::size_t count = scene_.materials.size();
  materials_.resize(count);
  for (std::size_t m = 0; m < count; ++m) {
    Material vertex = materials_[m];
    vertex.constants.on_mesh = true;
    vertex.constants.response = 0;
    vertex.constants.law.mu2 = vertex.constants.law.lambda = 0;
    materials_.push_back(vertex);
  }
}

std::uint16_t TileSolver::kind_of(std::uint16_t material, Index id) const {
  return static_cast<std::uint16_t>(mesh_.carries(id) ? material + scene_.materials.size()
                                                      : material);
}

std::vector<TileMesh::Law> TileSolver::laws_of(const std::vector<MaterialDesc>& materials) const {
  std::vector<TileMesh::Law> laws;
  for (const MaterialDesc& material : materials)
    laws.push_back({SolverMaterial(material), constants_of(material)});
  return laws;
}

void TileSolver::set_low_position(const Vec3& cells, float* lane) const {
  for (int a = 0; a < 3; ++a) {
    const Real high = lane[a * kLanes];
    const Real block = std::round((cells[a] - high) / 4);
    lane[(TileLayout::kStrain + a) * kLanes] = static_cast<float>(cells[a] - 4 * block - high);
  }
}

bool TileSolver::meets_mesh(const TileBlock& block) const {
  for (int r = 0; r < block.run_count; ++r)
    if (on_mesh(store_.runs()[static_cast<std::size_t>(block.first_run + r)])) return true;
  return false;
}

template <class F>
void TileSolver::each_vertex(F&& visit) const {
  parallel_for(static_cast<Index>(store_.blocks().size()), 4, [&](Index b) {
    const TileBlock& block = store_.blocks()[static_cast<std::size_t>(b)];
    for (int r = 0; r < block.run_count; ++r) {
      const TileRun& run = store_.runs()[static_cast<std::size_t>(block.first_run + r)];
      if (!on_mesh(run)) continue;
      for (int i = 0; i < run.count; ++i) {
        const std::int32_t t = run.first_tile + i / kLanes;
        visit(run, block, store_.tile(t) + i % kLanes,
              spare_.data() + std::size_t(t) * kMotionFloats + i % kLanes,
              store_.ids()[static_cast<std::size_t>(t) * kLanes +
                           static_cast<std::size_t>(i % kLanes)]);
      }
    }
  });
}

void TileSolver::place_vertices() {
  each_vertex([&](const TileRun&, const TileBlock& block, const float* lane, float*, Index id) {
    double* x = mesh_.position(id);
    for (int a = 0; a < 3; ++a)
      x[a] = 4.0 * block.coord[a] + double{lane[a * kLanes]} +
             double{lane[(TileLayout::kStrain + a) * kLanes]};
  });
}

TileSolver::StepSums TileSolver::mesh_response() {
  const Stopwatch watch(times_.elements);
  place_vertices();
  const TileMesh::Sums mesh = mesh_.evaluate(*kernels_);
  StepSums sums;
  sums.motion.element_rate = mesh.rate;
  sums.dissipation = mesh.dissipation;
  sums.clamped = mesh.clamped;
  return sums;
}

void TileSolver::kick_vertices(Real dt) {
  const Stopwatch watch(times_.elements);
  each_vertex([&](const TileRun& run, const TileBlock&, const float* lane, float* moves, Index id) {
    const Real volume = std::abs(lane[TileLayout::kVolume * kLanes]);
    const Real gain = dt / (materials_[run.material].desc.density * volume * dx_ * dx_);
    const Vec3 force = mesh_.force(id);
    for (int a = 0; a < 3; ++a) {
      float& v = moves[a * kLanes];
      if (is_flip())
        moves[(3 + a) * kLanes] = static_cast<float>(gain * force[a]);
      else
        v = static_cast<float>(v + gain * force[a]);
    }
  });
}

TileSolver::StepSums TileSolver::mesh_pass(Pass pass, const StepConstants& step, Real next) {
  StepSums sums = particle_pass(pass, step, Blocks::without_mesh);
  if (pass != Pass::scatter) {
    sums += particle_pass(Pass::mesh_gather, step, Blocks::with_mesh);
    sums += mesh_response();
  }
  if (pass != Pass::gather) {
    kick_vertices(next);
    particle_pass(Pass::mesh_scatter, step_constants(Pass::scatter, 0, next), Blocks::with_mesh);
  }
  return sums;
}

}  // namespace rend
