// What the reference solver tells: report, snapshot, and its state as a file.
#include "engine/core/parallel.h"
#include "engine/core/small_matrix.h"
#include "engine/mpm/material_state.h"
#include "engine/mpm/reference_solver.h"
#include "engine/mpm/state_file.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

constexpr Index kGrain = 1024;
constexpr const char* kKind = "reference";

struct ReportSums {
  Real mass = 0, kinetic = 0, affine = 0, elastic = 0, gravity = 0, power = 0, max_speed = 0;
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  Index yielded = 0, damaged = 0;
  ReportSums& operator+=(const ReportSums& o) {
    mass += o.mass;
    kinetic += o.kinetic;
    affine += o.affine;
    elastic += o.elastic;
    gravity += o.gravity;
    power += o.power;
    max_speed = std::max(max_speed, o.max_speed);
    momentum += o.momentum;
    angular += o.angular;
    yielded += o.yielded;
    damaged += o.damaged;
    return *this;
  }
};

}  // namespace

void ReferenceSolver::measure_energy(FrameReport& report) const {
  const Real inertia = transfer_.inertia * dx_ * dx_;
  const ReportSums sums = ordered_sum(particles_.count(), kGrain, ReportSums(), [&](Index p) {
    const auto i = static_cast<std::size_t>(p);
    const Real m = particles_.mass[i];
    const Vec3 &x = particles_.x[i], &v = particles_.v[i];
    ReportSums one;
    one.mass = m;
    one.momentum = m * v;
    one.angular = m * x.cross(v);
    if (transfer_.carried.affine) {
      // sum_i w r x (C r) with sum_i w r r^T = D 1.
      const Mat3& C = particles_.C[i];
      one.affine = 0.5 * m * inertia * C.squaredNorm();
      one.angular += m * inertia * Vec3(C(2, 1) - C(1, 2), C(0, 2) - C(2, 0), C(1, 0) - C(0, 1));
    }
    one.kinetic = 0.5 * m * v.squaredNorm();
    one.gravity = -m * gravity_.dot(x);
    one.power = m * gravity_.dot(v);
    one.max_speed = v.norm();
    if (mesh_.carries(p)) {
      one.power += particles_.force[i].dot(v);
      const VertexState state = mesh_.at_vertex(materials_, p);
      one.damaged = state.damaged;
      one.yielded = state.yielded;
      return one;
    }
    if (transfer_.carried.affine)
      one.power -= particles_.volume[i] * particles_.tau[i].cwiseProduct(particles_.C[i]).sum();
    one.damaged = is_damaged(p);
    one.yielded = particles_.yielded[i];
    one.elastic =
        particles_.volume[i] * elastic_energy_density(materials_[particles_.material[i]].constants,
                                                      particles_.F[i], one.damaged != 0);
    return one;
  });
  report.particles = particles_.count();
  report.mass = sums.mass;
  report.momentum = sums.momentum;
  report.angular_momentum = sums.angular;
  report.kinetic_energy = sums.kinetic;
  report.affine_energy = sums.affine;
  report.elastic_energy = sums.elastic + mesh_.elastic_energy(materials_, particles_.x);
  report.gravity_energy = sums.gravity;
  report.power = sums.power;
  report.dissipated_energy = balance_.dissipated;
  report.max_speed = sums.max_speed;
  report.yielded = sums.yielded;
  report.damaged = sums.damaged;
}

void ReferenceSolver::fill_report(FrameReport& report) {
  report.frame = frame_;
  report.time = time_;
  measure_energy(report);
  balance_.settle(report);
  report.state_hash = state_hash();
}

std::uint64_t ReferenceSolver::state_hash() const {
  std::uint64_t hash = hash_bytes(0, &time_, sizeof(time_));
  hash = hash_values(hash, particles_.x);
  hash = hash_values(hash, particles_.v);
  hash = hash_values(hash, particles_.C);
  hash = hash_values(hash, particles_.modes);
  hash = hash_values(hash, particles_.F);
  hash = hash_values(hash, particles_.tau_c);
  hash = hash_values(hash, mesh_.state().plastic_inverse);
  return hash_values(hash, mesh_.state().tau_c);
}

Snapshot ReferenceSolver::snapshot() const {
  Snapshot out;
  const std::size_t count = particles_.x.size();
  out.frame = frame_;
  out.time = time_;
  out.x = particles_.x;
  out.v.resize(count);
  out.damage.resize(count);
  out.stress.resize(count);
  out.yielded = particles_.yielded;
  parallel_for(particles_.count(), kGrain, [&](Index p) {
    const auto i = static_cast<std::size_t>(p);
    out.v[i] = particles_.v[i].cast<float>();
    if (mesh_.carries(p)) {
      const VertexState state = mesh_.at_vertex(materials_, p);
      out.damage[i] = state.damage;
      out.stress[i] = state.stress;
      out.yielded[i] = state.yielded;
      return;
    }
    const Real full = tau_c0(p);
    const Real lost = full > 0 ? 1 - particles_.tau_c[i] / full : 0;
    out.damage[i] = is_damaged(p) ? 1.0f : static_cast<float>(std::clamp(lost, 0.0, 1.0));
    out.stress[i] = static_cast<float>(symmetric_eigen(particles_.tau[i]).value.maxCoeff());
  });
  out.report = report_;
  return out;
}

void ReferenceSolver::save(std::ostream& out) const {
  StateWriter writer;
  writer.put(time_);
  writer.put(frame_);
  writer.put(balance_);
  writer.put(motion_);
  writer.put(gravity_);
  PullForce::visit_state(pull_, [&](const auto& value) { writer.put(value); });
  for (const SolverMaterial& material : materials_) put_material(writer, material.desc);
  writer.put(particles_.x);
  writer.put(particles_.v);
  writer.put(particles_.C);
  writer.put(particles_.modes);
  writer.put(particles_.F);
  writer.put(particles_.tau);
  writer.put(particles_.tau_c);
  writer.put(particles_.mass);
  writer.put(particles_.yielded);
  writer.put(particles_.force);
  writer.put(mesh_.state().plastic_inverse);
  writer.put(mesh_.state().tau);
  writer.put(mesh_.state().tau_c);
  writer.put(mesh_.state().yielded);
  writer.write(out, kKind, scene_hash_);
}

void ReferenceSolver::load(std::istream& in) {
  StateReader reader(in, kKind, scene_hash_);
  State state;
  Index frame;
  Vec3 gravity;
  PullForce pull;
  reader.get(state.time);
  reader.get(frame);
  reader.get(state.balance);
  reader.get(state.motion);
  reader.get(gravity);
  PullForce::visit_state(pull, [&](auto& value) { reader.get(value); });
  std::vector<SolverMaterial> materials;
  for (const SolverMaterial& material : materials_)
    materials.emplace_back(get_material(reader, material.desc));
  const std::size_t count = particles_.x.size();
  reader.get(state.particles.x, count);
  reader.get(state.particles.v, count);
  reader.get(state.particles.C, particles_.C.size());
  reader.get(state.particles.modes, particles_.modes.size());
  reader.get(state.particles.F, count);
  reader.get(state.particles.tau, count);
  reader.get(state.particles.tau_c, count);
  reader.get(state.particles.mass, count);
  reader.get(state.particles.yielded, count);
  reader.get(state.particles.force, particles_.force.size());
  reader.get(state.mesh.plastic_inverse, mesh_.element_count());
  reader.get(state.mesh.tau, mesh_.element_count());
  reader.get(state.mesh.tau_c, mesh_.element_count());
  reader.get(state.mesh.yielded, mesh_.element_count());
  reader.finish();
  StateReader::require(std::isfinite(state.time) && state.time >= 0, "times");
  StateReader::require(std::all_of(state.particles.x.begin(), state.particles.x.end(),
                                   [&](const Vec3& x) { return inside_domain(x); }),
                       "positions");
  state.particles.volume = particles_.volume;
  state.particles.material = particles_.material;

  good_ = std::move(state);
  restore();
  frame_ = frame;
  gravity_ = gravity;
  pull_ = pull;
  materials_ = std::move(materials);
  report_ = {};
  fill_report(report_);
}

double ReferenceSolver::bytes_per_particle() const {
  const Real each = sizeof(Vec3) * 2 + sizeof(Mat3) * (transfer_.carried.affine ? 3 : 2) +
                    (transfer_.carried.multilinear ? sizeof(VelocityModes) : 0) + sizeof(Real) * 3 +
                    sizeof(std::uint16_t) + sizeof(std::uint8_t);
  const Real count = std::max<Real>(1, particles_.count());
  return 2 * each + sizeof(Vec3i) + (strength_.empty() ? 0 : sizeof(float)) +
         (grid_.bytes() + mesh_.bytes()) / count;
}

}  // namespace rend
