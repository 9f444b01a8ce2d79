// frames.csv.
#include "app/frame_table.h"

#include "engine/mpm/energy_balance.h"

#include <fmt/format.h>

#include <functional>

namespace rend {

namespace {

struct Column {
  const char* name;
  std::function<std::string(const Frame&, const FrameCost&)> text;
};

template <class Get>
Column from_report(const char* name, Get get) {
  return {name, [get](const Frame& f, const FrameCost&) { return fmt::format("{}", get(f.snapshot->report)); }};
}

const std::vector<Column>& columns() {
  using R = FrameReport;
  static const std::vector<Column> all = {
      from_report("frame", [](const R& r) { return r.frame; }),
      from_report("time", [](const R& r) { return r.time; }),
      from_report("substeps", [](const R& r) { return r.substeps; }),
      from_report("dt_min", [](const R& r) { return r.dt_min; }),
      from_report("dt_max", [](const R& r) { return r.dt_max; }),
      from_report("sim_seconds", [](const R& r) { return r.sim_seconds; }),
      {"post_seconds", [](const Frame&, const FrameCost& c) { return fmt::format("{}", c.post_seconds); }},
      {"render_seconds", [](const Frame&, const FrameCost& c) { return fmt::format("{}", c.render_seconds); }},
      from_report("particles", [](const R& r) { return r.particles; }),
      from_report("mass", [](const R& r) { return r.mass; }),
      from_report("momentum_x", [](const R& r) { return r.momentum.x(); }),
      from_report("momentum_y", [](const R& r) { return r.momentum.y(); }),
      from_report("momentum_z", [](const R& r) { return r.momentum.z(); }),
      from_report("angular_momentum_x", [](const R& r) { return r.angular_momentum.x(); }),
      from_report("angular_momentum_y", [](const R& r) { return r.angular_momentum.y(); }),
      from_report("angular_momentum_z", [](const R& r) { return r.angular_momentum.z(); }),
      from_report("kinetic_energy", [](const R& r) { return r.kinetic_energy; }),
      from_report("elastic_energy", [](const R& r) { return r.elastic_energy; }),
      from_report("gravity_energy", [](const R& r) { return r.gravity_energy; }),
      from_report("dissipated_energy", [](const R& r) { return r.dissipated_energy; }),
      from_report("affine_energy", [](const R& r) { return r.affine_energy; }),
      from_report("friction_energy", [](const R& r) { return r.friction_energy; }),
      from_report("transfer_loss", [](const R& r) { return r.transfer_loss; }),
      from_report("energy_drift", [](const R& r) { return energy_drift(r); }),
      from_report("external_work", [](const R& r) { return r.external_work; }),
      from_report("max_speed", [](const R& r) { return r.max_speed; }),
      from_report("yielded", [](const R& r) { return r.yielded; }),
      from_report("damaged", [](const R& r) { return r.damaged; }),
      {"broken_edges", [](const Frame& f, const FrameCost&) { return fmt::format("{}", f.fracture.broken_edges); }},
      {"pieces", [](const Frame& f, const FrameCost&) { return fmt::format("{}", f.fracture.pieces); }},
      {"surface_vertices", [](const Frame& f, const FrameCost&) { return fmt::format("{}", f.surface->vertex_count()); }},
      {"surface_triangles",
       [](const Frame& f, const FrameCost&) { return fmt::format("{}", f.surface->triangle_count()); }},
      {"surface_volume", [](const Frame& f, const FrameCost&) { return fmt::format("{}", enclosed_volume(*f.surface)); }},
      {"state_hash", [](const Frame& f, const FrameCost&) { return fmt::format("{:016x}", f.snapshot->report.state_hash); }},
  };
  return all;
}

}  // namespace

std::string frame_table_header() {
  std::string line;
  for (const Column& c : columns()) line += (line.empty() ? "" : ",") + std::string(c.name);
  return line + "\n";
}

std::string frame_table_row(const Frame& frame, const FrameCost& cost) {
  std::string line;
  for (const Column& c : columns()) line += (line.empty() ? "" : ",") + c.text(frame, cost);
  return line + "\n";
}

}  // namespace rend
