// Statistics of ensembles.
#include "bench/crack_row.h"

#include <fmt/format.h>

#include <cmath>

namespace rend {

Spread spread(const std::vector<Real>& values) {
  if (values.empty()) return {};
  const Real n = static_cast<Real>(values.size());
  Spread out;
  for (Real v : values) out.mean += v / n;
  Real squares = 0;
  for (Real v : values) squares += (v - out.mean) * (v - out.mean);
  if (values.size() > 1) out.deviation = std::sqrt(squares / (n - 1));
  return out;
}

void fill_spreads(CrackRow& row, const std::vector<Torn>& runs) {
  std::vector<Real> dissipated, area, pieces, peak;
  for (const Torn& run : runs) {
    ++row.runs;
    row.cpu_seconds += run.cost.cpu_seconds;
    if (run.cost.status != Status::ok) {
      ++row.failed;
      continue;
    }
    dissipated.push_back(run.dissipated);
    area.push_back(run.crack_area);
    pieces.push_back(static_cast<Real>(run.pieces));
    peak.push_back(run.peak_force);
  }
  row.particles = runs.empty() ? 0 : runs.front().cost.particles;
  row.modulus = runs.empty() ? 0 : runs.front().modulus;
  row.dissipated = spread(dissipated);
  row.crack_area = spread(area);
  row.pieces = spread(pieces);
  row.peak_force = spread(peak);
}

bool same_study(const CrackRow& a, const CrackRow& b) {
  return a.body == b.body && a.law == b.law && a.force == b.force && a.varied == b.varied;
}

Real energy_slope(const std::vector<CrackRow>& rows, const CrackRow& study) {
  Real n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const CrackRow& row : rows) {
    if (!same_study(row, study) || !(row.dissipated.mean > 0)) continue;
    const Real u = std::log(row.dx), v = std::log(row.dissipated.mean);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

std::string crack_csv(const std::vector<CrackRow>& rows) {
  std::string out =
      "version,body,law,force,varied,dx,modulus,particles,runs,failed,dissipated,dissipated_sd,"
      "crack_area,crack_area_sd,pieces,pieces_sd,peak_force,peak_force_sd,cpu_s\n";
  for (const CrackRow& r : rows)
    out += fmt::format(
        "{},{},{},{},{},{:.6g},{:.6g},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:."
        "6g},{:.6g}\n",
        REND_VERSION, r.body, r.law, r.force, r.varied, r.dx, r.modulus, r.particles, r.runs,
        r.failed, r.dissipated.mean, r.dissipated.deviation, r.crack_area.mean,
        r.crack_area.deviation, r.pieces.mean, r.pieces.deviation, r.peak_force.mean,
        r.peak_force.deviation, r.cpu_seconds);
  return out;
}

}  // namespace rend
