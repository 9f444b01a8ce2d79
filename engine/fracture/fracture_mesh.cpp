// Composes the parts in the order of a frame: which edges break, what that cuts, where it lies.
#include "engine/fracture/fracture_mesh.h"

#include "engine/core/error.h"
#include "engine/core/stopwatch.h"
#include "engine/fracture/break_criterion.h"
#include "engine/fracture/crack_mesh.h"
#include "engine/fracture/pieces.h"
#include "engine/fracture/rotation_field.h"
#include "engine/fracture/smoothing.h"
#include "engine/fracture/surface_builder.h"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <string>
#include <utility>

namespace rend {

namespace {

using Clock = std::chrono::steady_clock;

Real seconds_since(Clock::time_point start) {
  return std::chrono::duration<Real>(Clock::now() - start).count();
}

// CPU seconds since `start`, which moves on to now.
Real lap(Real& start) {
  const Real before = std::exchange(start, cpu_seconds());
  return start - before;
}

// What does not change during a run; shared between runs over the same model.
struct Setup {
  Setup(const SceneDesc& scene, const Model& model)
      : tables(model), crease(model.crease), criterion(scene, model, tables) {}
  TetTables tables;
  std::vector<std::uint8_t> crease;
  BreakCriterion criterion;
};

// A break table in the numbering of the tables, sorted by frame.
struct Playback {
  std::vector<Index> edge, frame;
  std::vector<Real> t;
  std::vector<std::pair<Index, Vec3>> centre;  // by tet
  std::vector<Index> loose;
  std::vector<Eigen::Quaterniond> loose_rotation;
};

}  // namespace

struct FractureMesh::State {
  State(std::shared_ptr<const Setup> shared, const FractureDesc& desc)
      : setup(std::move(shared)), settings(desc), criterion(setup->criterion) {
    criterion.set(desc);
    reset();
  }

  void reset() {
    crack.emplace(setup->tables);
    pieces.emplace(setup->tables);
    rotations.emplace(setup->tables.particle_count());
    rotation_frame = -1;
    nearness.clear();
  }

  void load(const BreakTable& table);
  std::vector<Index> due(Index frame) const;
  void cut(std::span<const Index> edges, const Snapshot& snapshot);
  void place(Index first_new, const Snapshot& snapshot);
  void turn(const Snapshot& snapshot);

  std::shared_ptr<const Setup> setup;
  FractureDesc settings;
  BreakCriterion criterion;
  std::optional<Playback> playback;
  std::optional<CrackMesh> crack;
  std::optional<Pieces> pieces;
  std::optional<RotationField> rotations;
  std::vector<float> nearness;  // of the last update, or what a playback was given
  Index rotation_frame = -1;
  Real rotation_time = 0;
  Index last_frame = 0;
  Index new_broken = 0;
  mutable FractureStages stages;   // clocks only
  mutable SurfaceScratch scratch;  // no value outlives a call
  Real update_seconds = 0;
  mutable Real surface_seconds = 0;
};

void FractureMesh::State::load(const BreakTable& table) {
  const TetTables& t = setup->tables;
  if (table.edge.size() != table.frame.size() || table.loose.size() != table.loose_rotation.size())
    throw Error("break_table", "columns differ in length");
  std::vector<std::pair<Index, Index>> rows;
  for (std::size_t i = 0; i < table.edge.size(); ++i) {
    const auto [a, b] = table.edge[i];
    const bool valid = a >= 0 && a < t.particle_count();
    const auto begin = t.edge_to.begin() + (valid ? t.edge_row[a] : 0);
    const auto end = t.edge_to.begin() + (valid ? t.edge_row[a + 1] : 0);
    auto at = std::lower_bound(begin, end, b);
    if (at == end || *at != b)
      throw Error(
          "break_table/edge/" + std::to_string(i),
          "particles " + std::to_string(a) + " and " + std::to_string(b) + " share no edge");
    for (; at != end && *at == b; ++at)
      rows.emplace_back(table.frame[i], static_cast<Index>(at - t.edge_to.begin()));
  }
  std::sort(rows.begin(), rows.end(),
            [](const auto& x, const auto& y) { return x.second < y.second; });
  rows.erase(std::unique(rows.begin(), rows.end(),
                         [](const auto& x, const auto& y) { return x.second == y.second; }),
             rows.end());
  std::vector<Index> all;
  for (const auto& row : rows) all.push_back(row.second);
  crack->break_edges(all, 0);
  std::vector<Index> records(all.size());
  std::iota(records.begin(), records.end(), 0);
  smooth_middles(*crack, records, settings.smoothing_iterations);
  crack->place_centres();
  Playback p;
  for (Index r : crack->born_centres())
    p.centre.emplace_back(crack->cracked()[r].tet, crack->centre(r));
  std::sort(p.centre.begin(), p.centre.end(),
            [](const auto& x, const auto& y) { return x.first < y.first; });
  for (std::size_t i = 0; i < all.size(); ++i) p.t.push_back(crack->broken_edges()[i].t);
  std::vector<Index> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index x, Index y) { return rows[x].first < rows[y].first; });
  std::vector<Real> sorted_t;
  for (Index i : order) {
    p.frame.push_back(rows[i].first);
    p.edge.push_back(rows[i].second);
    sorted_t.push_back(p.t[i]);
  }
  p.t = std::move(sorted_t);
  p.loose = table.loose;
  p.loose_rotation = table.loose_rotation;
  playback = std::move(p);
  reset();
}

std::vector<Index> FractureMesh::State::due(Index frame) const {
  const auto from = crack->broken_edges().size();
  const auto to = std::upper_bound(playback->frame.begin(), playback->frame.end(), frame) -
                  playback->frame.begin();
  return {playback->edge.begin() + static_cast<std::ptrdiff_t>(from), playback->edge.begin() + to};
}

void FractureMesh::State::cut(std::span<const Index> edges, const Snapshot& snapshot) {
  Real start = cpu_seconds();
  const auto first_new = static_cast<Index>(crack->broken_edges().size());
  crack->break_edges(edges, snapshot.frame);
  stages.cut = lap(start);
  new_broken = static_cast<Index>(crack->broken_edges().size()) - first_new;
  if (new_broken == 0) return;
  place(first_new, snapshot);
  stages.smooth = lap(start);
  pieces->update(*crack);
  stages.pieces = lap(start);
}

// What is new finds its place for good: once a face is seen, it moves with its particles alone.
void FractureMesh::State::place(Index first_new, const Snapshot& snapshot) {
  const auto& broken = crack->broken_edges();
  if (playback) {
    for (std::size_t r = static_cast<std::size_t>(first_new); r < broken.size(); ++r)
      crack->place_middle(static_cast<Index>(r), playback->t[r]);
    crack->place_centres();
    for (Index r : crack->born_centres()) {
      const auto at = std::lower_bound(
          playback->centre.begin(), playback->centre.end(), crack->cracked()[r].tet,
          [](const auto& known, Index tet) { return known.first < tet; });
      crack->place_centre(r, at->second);
    }
    return;
  }
  std::vector<Index> fresh(static_cast<std::size_t>(new_broken));
  std::iota(fresh.begin(), fresh.end(), first_new);
  const CrackMotion motion{snapshot.x, &*rotations};
  smooth_middles(*crack, fresh, settings.smoothing_iterations, &motion);
  crack->place_centres();
}

void FractureMesh::State::turn(const Snapshot& snapshot) {
  rotations->fit(crack->near_crack(), snapshot.x, *crack);
  if (playback)
    for (std::size_t i = 0; i < playback->loose.size(); ++i) {
      const Index p = playback->loose[i];
      if (crack->linked(p).empty()) rotations->set(p, playback->loose_rotation[i]);
    }
  rotation_frame = snapshot.frame;
  rotation_time = snapshot.time;
}

FractureMesh::FractureMesh(const SceneDesc& scene, const Model& model)
    : state_(std::make_unique<State>(std::make_shared<const Setup>(scene, model), scene.fracture)) {
}

FractureMesh::FractureMesh(const SceneDesc& scene, const Model& model, const BreakTable& table)
    : FractureMesh(scene, model) {
  state_->load(table);
}

FractureMesh::FractureMesh(std::unique_ptr<State> state) : state_(std::move(state)) {}
FractureMesh::~FractureMesh() = default;
FractureMesh::FractureMesh(FractureMesh&&) noexcept = default;
FractureMesh& FractureMesh::operator=(FractureMesh&&) noexcept = default;

FractureMesh FractureMesh::fresh(const FractureDesc& settings) const {
  auto state = std::make_unique<State>(state_->setup, settings);
  state->criterion = state_->criterion;
  state->criterion.set(settings);
  return FractureMesh(std::move(state));
}

void FractureMesh::set_materials(const std::vector<MaterialDesc>& materials) {
  state_->criterion.set_materials(materials);
}

FractureMesh FractureMesh::playback(const BreakTable& table) const {
  FractureMesh mesh = fresh(state_->settings);
  mesh.state_->load(table);
  return mesh;
}

void FractureMesh::update(const Snapshot& snapshot) {
  const auto start = Clock::now();
  State& s = *state_;
  if (snapshot.x.size() != s.setup->tables.X.size())
    throw Error("snapshot", "has " + std::to_string(snapshot.x.size()) +
                                " particles, the model has " +
                                std::to_string(s.setup->tables.X.size()));
  if (s.playback && snapshot.frame < s.last_frame) s.reset();
  s.last_frame = snapshot.frame;
  s.stages = {};
  Real clock = cpu_seconds();
  std::vector<Index> edges;
  if (s.playback) {
    edges = s.due(snapshot.frame);
  } else {
    BreakCriterion::Verdict verdict = s.criterion.find(snapshot, *s.crack, *s.rotations);
    edges = std::move(verdict.edges);
    s.nearness = std::move(verdict.nearness);
  }
  // A particle that comes loose at once keeps the turn it had with the neighbours it is losing.
  std::vector<Index> unknown;
  for (Index e : edges)
    for (Index p : s.setup->tables.edge(e))
      if (!s.rotations->known(p)) unknown.push_back(p);
  std::sort(unknown.begin(), unknown.end());
  unknown.erase(std::unique(unknown.begin(), unknown.end()), unknown.end());
  s.rotations->fit_robust(unknown, snapshot.x, *s.crack);
  s.stages.test = lap(clock);
  s.cut(edges, snapshot);
  clock = cpu_seconds();
  s.turn(snapshot);
  s.stages.rotations = lap(clock);
  s.update_seconds = seconds_since(start);
  s.surface_seconds = 0;
}

SurfaceMesh FractureMesh::surface(const Snapshot& snapshot) const {
  SurfaceMesh mesh;
  surface(snapshot, mesh);
  return mesh;
}

void FractureMesh::surface(const Snapshot& snapshot, SurfaceMesh& mesh) const {
  const auto start = Clock::now();
  const State& s = *state_;
  SurfaceTimes times;
  if (snapshot.frame == s.rotation_frame && snapshot.time == s.rotation_time) {
    build_surface(*s.crack, *s.pieces, *s.rotations, s.setup->crease, snapshot, s.nearness,
                  s.settings.smallest_fragment, mesh, s.scratch, &times);
  } else {
    RotationField rotations = *s.rotations;
    rotations.fit(s.crack->near_crack(), snapshot.x, *s.crack);
    build_surface(*s.crack, *s.pieces, rotations, s.setup->crease, snapshot, s.nearness,
                  s.settings.smallest_fragment, mesh, s.scratch, &times);
  }
  s.surface_seconds = seconds_since(start);
  s.stages.positions = times.positions;
  s.stages.triangles = times.triangles;
  s.stages.normals = times.normals;
}

const std::vector<float>& FractureMesh::nearness() const { return state_->nearness; }
void FractureMesh::set_nearness(std::vector<float> nearness) {
  state_->nearness = std::move(nearness);
}

FractureReport FractureMesh::report() const {
  const State& s = *state_;
  FractureReport report;
  report.broken_edges = static_cast<Index>(s.crack->broken_edges().size());
  report.pieces = s.pieces->count();
  report.new_broken = s.new_broken;
  report.seconds = s.update_seconds + s.surface_seconds;
  return report;
}

FractureStages FractureMesh::stages() const { return state_->stages; }

BreakTable FractureMesh::break_table() const {
  BreakTable table;
  for (const BrokenEdge& b : state_->crack->broken_edges()) {
    table.edge.push_back(state_->crack->ends(b));
    table.frame.push_back(b.frame);
  }
  for (Index p : state_->crack->near_crack())
    if (state_->crack->linked(p).empty()) {
      table.loose.push_back(p);
      table.loose_rotation.push_back(state_->rotations->of(p));
    }
  return table;
}

const CrackMesh& FractureMesh::crack() const { return *state_->crack; }

double FractureMesh::bytes_per_particle() const {
  const State& s = *state_;
  const double count = std::max<double>(1, static_cast<double>(s.setup->tables.X.size()));
  return s.setup->tables.bytes_per_particle() +
         (s.crack->bytes() + s.rotations->bytes() + s.scratch.bytes() + 8 * count) / count;
}

}  // namespace rend
