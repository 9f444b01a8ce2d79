// The common rule of hard cases.
#include "tests/hard_cases/hard_run.h"

#include "engine/mpm/energy_balance.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdio>

namespace rend {

std::vector<SolverKind> all_solvers() {
  std::vector<SolverKind> kinds = {{"reference"}};
  for (const TileKernels* k : all_tile_kernels())
    kinds.push_back({std::string("tile ") + k->name, k});
  return kinds;
}

std::vector<SolverKind> main_solvers() {
  std::vector<SolverKind> kinds = {{"reference"}};
  const auto kernels = all_tile_kernels();
  if (!kernels.empty()) kinds.push_back({"tile", kernels.front()});
  return kinds;
}

std::unique_ptr<Solver> make(const SolverKind& kind, SceneDesc scene, const Model& model) {
  scene.solver.precision = kind.reference() ? Precision::float64 : Precision::float32;
  if (kind.reference()) return std::make_unique<ReferenceSolver>(scene, model);
  return std::make_unique<TileSolver>(scene, model, kind.kernels);
}

namespace {

bool all_finite(const Snapshot& s) {
  for (std::size_t p = 0; p < s.x.size(); ++p)
    if (!s.x[p].allFinite() || !s.v[p].allFinite() || !std::isfinite(s.stress[p]) ||
        !std::isfinite(s.damage[p]))
      return false;
  const FrameReport& r = s.report;
  return std::isfinite(mechanical_energy(r) + r.dissipated_energy + r.transfer_loss +
                       r.external_work + r.friction_energy) &&
         r.momentum.allFinite() && r.angular_momentum.allFinite();
}

}  // namespace

Run run_frames(Solver& solver, int frames, Real duration) {
  Run run;
  Snapshot before = solver.snapshot();
  for (int n = 0; n < frames; ++n) {
    run.last = solver.advance(duration);
    const Snapshot now = solver.snapshot();
    CHECK(all_finite(now));
    if (run.last.status != Status::ok) {
      CHECK_FALSE(run.last.reason.empty());
      CHECK(run.last.reason.find("step") != std::string::npos);
      CHECK(now.report.time == before.report.time);
      CHECK(now.report.state_hash == before.report.state_hash);
      return run;
    }
    ++run.frames;
    run.steps += run.last.substeps;
    run.clamped += run.last.clamped;
    run.seconds = run.last.time;
    run.most_energy = std::max(run.most_energy, mechanical_energy(run.last));
    run.least_drift = std::min(run.least_drift, energy_drift(run.last));
    before = now;
  }
  run.finished = true;
  return run;
}

void note(const char* id, const std::string& what, const std::string& solver,
          const std::string& outcome) {
  const char* name = std::getenv("REND_HARD_TABLE");
  if (!name) return;
  if (std::FILE* file = std::fopen(name, "a")) {
    fmt::print(file, "| {} | {} | {} | {} |\n", id, what, solver, outcome);
    std::fclose(file);
  }
}

void note(const char* id, const std::string& what, const SolverKind& kind, const Run& run,
          const std::string& more) {
  std::string outcome = run.finished ? fmt::format("finite for {} steps", run.steps)
                                     : fmt::format("stops: {} (frame {}), last good frame kept",
                                                   status_name(run.last.status), run.frames + 1);
  if (run.clamped > 0) outcome += fmt::format(", {} clamped", run.clamped);
  if (!more.empty()) outcome += ", " + more;
  note(id, what, kind.name, outcome);
}

LatticeModel block(const Vec3i& count, const Vec3& velocity) {
  LatticeModel body;
  body.add_box(-0.25 * count.cast<Real>(), count, 0.5, velocity, 0.2);
  return body;
}

ColliderDesc plane(const Vec3& normal, const Vec3& at, Contact contact, Real friction) {
  ColliderDesc out;
  out.shape = PlaneDesc{normal};
  out.contact = contact;
  out.friction = friction;
  out.motion = {{0, at, Vec3::Zero()}};
  return out;
}

std::vector<ColliderDesc> grips(Real half, Real speed, Real duration) {
  std::vector<ColliderDesc> out;
  for (const Real side : {-1.0, 1.0}) {
    ColliderDesc grip;
    grip.shape = BoxDesc{Vec3(3, 40, 40)};
    grip.contact = Contact::stick;
    grip.motion = {{0, Vec3(side * half, 0, 0), Vec3::Zero()},
                   {duration, Vec3(side * (half + speed * duration), 0, 0), Vec3::Zero()}};
    out.push_back(grip);
  }
  return out;
}

}  // namespace rend
