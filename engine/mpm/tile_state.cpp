// Live changes of the tile solver, and its state as a file.
#include "engine/core/error.h"
#include "engine/mpm/material_state.h"
#include "engine/mpm/state_file.h"
#include "engine/mpm/tile_solver.h"

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

constexpr const char* kKind = "tile";

}  // namespace

// Room for the state of a law that no material had before.
void TileSolver::add_groups(const TileLayout& needed) {
  const TileLayout before = store_.layout();
  store_.change_layout(needed);
  AlignedFloats motion_copy;
  const std::size_t floats = std::size_t(store_.tile_count()) * kMotionFloats;
  motion_copy.reserve(std::max(floats, std::size_t(store_.tile_count()) * needed.floats()));
  std::copy(motion(), motion() + floats, motion_copy.data());
  std::swap(spare_, motion_copy);
  for (const TileRun& run : store_.runs())
    for (int i = 0; i < run.tiles() * kLanes; ++i) {
      float* lane = store_.tile(run.first_tile + i / kLanes) + i % kLanes;
      const Index id =
          store_.ids()[std::size_t(run.first_tile) * kLanes + std::min(i, run.count - 1)];
      const float threshold = static_cast<float>(tau_c0(run.material, id));
      if (before.tau_c < 0 && needed.tau_c >= 0) lane[needed.tau_c * kLanes] = threshold;
      if (before.tau_c0 < 0 && needed.tau_c0 >= 0) lane[needed.tau_c0 * kLanes] = threshold;
    }
}

void TileSolver::set_material(std::size_t index, const MaterialDesc& material) {
  FrameReport energy_before, energy_after;
  measure_energy(energy_before);
  const Real before = initial_threshold(materials_.at(index).desc.yield_surface);
  materials_[index] = {material, constants_of(material)};
  add_mesh_materials();
  if (!mesh_.empty()) mesh_.set_law(index, laws_of({material})[0]);
  const Real now = initial_threshold(material.yield_surface);
  const bool had_threshold = store_.layout().tau_c >= 0;
  const TileLayout needed = needed_layout(store_.layout(), materials_);
  if (needed.groups != store_.layout().groups) add_groups(needed);
  const TileLayout& layout = store_.layout();
  if (layout.tau_c >= 0)
    for (const TileRun& run : store_.runs()) {
      if (run.material != index) continue;
      for (int i = 0; i < run.count; ++i) {
        const std::int32_t t = run.first_tile + i / kLanes;
        float* lane = store_.tile(t) + i % kLanes;
        const Index id =
            store_.ids()[std::size_t(run.first_tile) * kLanes + static_cast<std::size_t>(i)];
        float& state = lane[layout.tau_c * kLanes];
        if (had_threshold && (state > 0 || before == 0))
          state = static_cast<float>(before > 0 ? state * (now / before) : tau_c0(index, id));
        if (layout.tau_c0 >= 0)
          lane[layout.tau_c0 * kLanes] = static_cast<float>(tau_c0(index, id));
      }
    }
  measure_motion();
  measure_energy(energy_after);
  balance_.rebase(energy_before, energy_after);
  report_.power = energy_after.power;
}

void TileSolver::set_gravity(const Vec3& gravity) {
  FrameReport before, after;
  measure_energy(before);
  gravity_ = gravity;
  measure_energy(after);
  balance_.rebase(before, after);
  report_.power = after.power;
}

TileSolver::State TileSolver::state() const {
  State s;
  s.store = store_.state();
  s.mesh = mesh_.state();
  s.motion.assign(motion(), motion() + std::size_t(store_.tile_count()) * kMotionFloats);
  s.time = time_;
  s.balance = balance_;
  s.extremes = motion_;
  s.excess = excess_;
  return s;
}

void TileSolver::restore(const State& s) {
  islands_.clear();
  store_.restore(s.store);
  mesh_.restore(s.mesh);
  if (!mesh_.empty()) place_vertices();
  make_room_for_motion();
  std::copy(s.motion.begin(), s.motion.end(), motion());
  time_ = s.time;
  balance_ = s.balance;
  motion_ = s.extremes;
  excess_ = s.excess;
  update_topology();
}

void TileSolver::save(std::ostream& out) const {
  StateWriter writer;
  const State s = state();
  writer.put(s.time);
  writer.put(frame_);
  writer.put(s.balance);
  writer.put(s.extremes);
  writer.put(s.excess);
  writer.put(gravity_);
  PullForce::visit_state(pull_, [&](const auto& value) { writer.put(value); });
  for (std::size_t m = 0; m < scene_.materials.size(); ++m)
    put_material(writer, materials_[m].desc);
  writer.put(s.store.layout);
  writer.put(s.store.blocks);
  writer.put(s.store.runs);
  writer.put(s.store.ids);
  writer.put(s.store.tiles);
  writer.put(s.motion);
  writer.put(s.mesh.tiles);
  writer.put(s.mesh.pull);
  writer.write(out, kKind, scene_hash_);
}

void TileSolver::load(std::istream& in) {
  StateReader reader(in, kKind, scene_hash_);
  State s;
  Index frame;
  Vec3 gravity;
  PullForce pull;
  reader.get(s.time);
  reader.get(frame);
  reader.get(s.balance);
  reader.get(s.extremes);
  reader.get(s.excess);
  reader.get(gravity);
  PullForce::visit_state(pull, [&](auto& value) { reader.get(value); });
  std::vector<Material> materials;
  for (std::size_t m = 0; m < scene_.materials.size(); ++m) {
    const MaterialDesc desc = get_material(reader, materials_[m].desc);
    materials.push_back({desc, constants_of(desc)});
  }
  reader.get(s.store.layout);
  reader.get(s.store.blocks);
  reader.get(s.store.runs);
  reader.get(s.store.ids);
  reader.get(s.store.tiles);
  reader.get(s.motion);
  reader.get(s.mesh.tiles);
  reader.get(s.mesh.pull);
  reader.finish();
  StateReader::require(std::isfinite(s.time) && s.time >= 0 && std::isfinite(s.excess), "times");
  StateReader::require(
      s.store.fits(store_.particle_count(), materials_.size()) &&
          s.motion.size() == s.store.ids.size() / kLanes * kMotionFloats &&
          needed_layout(s.store.layout, materials).groups == s.store.layout.groups &&
          mesh_.fits(s.mesh),
      "tiles");
  materials_ = std::move(materials);
  add_mesh_materials();
  for (std::size_t m = 0; m < scene_.materials.size() && !mesh_.empty(); ++m)
    mesh_.set_law(m, laws_of({materials_[m].desc})[0]);
  restore(s);
  frame_ = frame;
  gravity_ = gravity;
  pull_ = pull;
  report_ = {};
  fill_report(report_);
}

}  // namespace rend
