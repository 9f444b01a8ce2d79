// Error against CPU time, one plot a problem, and float against double.
#include "bench/bench_accuracy.h"

#include "bench/problems/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

std::uint32_t color_of(const SolverDesc& solver) {
  switch (solver.transfer) {
    case Transfer::pic:
      return 0x8a8f98;
    case Transfer::flip:
      return solver.flip_ratio > 0.995 ? 0xc0504d : solver.flip_ratio > 0.97 ? 0xd98c3f : 0xe3b98a;
    case Transfer::apic:
      return 0x2166ac;
    case Transfer::rpic:
      return 0x5aa9a3;
    case Transfer::polypic:
      return 0x7b4fa3;
    case Transfer::xpic:
      return 0x4d8b31;
  }
  return 0;
}

// Hollow: tile solver. Disc, square (cubic kernel) or diamond (mesh forces).
Marker marker_of(const AccuracyRow& row) {
  const bool tile = row.solver.precision == Precision::float32;
  if (row.force == ForceKind::mesh) return tile ? Marker::diamond : Marker::full_diamond;
  if (tile) return Marker::ring;
  return row.solver.kernel == Kernel::cubic ? Marker::square : Marker::disc;
}

std::string label_of(const AccuracyRow& row) {
  std::string label = transfer_name(row.solver);
  if (row.solver.kernel == Kernel::cubic) label += " cubic";
  if (row.solver.force_form == ForceForm::gradient) label += " gradient";
  if (row.force == ForceKind::mesh) label += ", mesh forces";
  if (row.solver.deformation_update == DeformationUpdate::linear) label += ", linear F";
  if (row.rule == SofteningRule::explicit_rule) label += ", explicit";
  return label + (row.solver.precision == Precision::float32 ? ", tile" : "");
}

using Choose = std::function<bool(const AccuracyRow&)>;

// One curve a method, refined in cells; what `choose` lets through.
std::vector<PlotSeries> curves(const std::vector<AccuracyRow>& rows, const Choose& choose,
                               bool against_cells = false) {
  std::vector<PlotSeries> out;
  std::vector<const AccuracyRow*> first;
  for (const AccuracyRow& row : rows) {
    if (!choose(row) || !(row.error > 0)) continue;
    const auto same = std::find_if(first.begin(), first.end(),
                                   [&](const AccuracyRow* f) { return f->same_method(row); });
    const auto at = static_cast<std::size_t>(same - first.begin());
    if (same == first.end()) {
      first.push_back(&row);
      PlotSeries series;
      series.label = label_of(row);
      series.color = color_of(row.solver);
      const bool linear = row.solver.deformation_update == DeformationUpdate::linear;
      if (row.rule == SofteningRule::explicit_rule)
        series.color = linear ? 0x8a8f98 : 0xc0504d;
      else if (linear)
        series.color = 0xd98c3f;
      if (row.force == ForceKind::particle && row.particles_per_cell != 8 && !against_cells) {
        series.label += fmt::format(", {:g} a cell", row.particles_per_cell);
        series.color = row.particles_per_cell < 8 ? 0x7fb3e0 : 0x0b2f5c;
      }
      series.marker = marker_of(row);
      series.dashed = row.solver.kernel == Kernel::cubic;
      out.push_back(series);
    }
    const Real x = against_cells ? row.cells : row.cost.cpu_seconds;
    out[at].points.push_back({x, row.error, 0, 0});
  }
  return out;
}

LogPlot work_plot(const std::vector<AccuracyRow>& rows, const std::string& problem,
                  const Choose& choose, const std::string& title, const std::string& error) {
  LogPlot plot;
  plot.name = "accuracy_" + problem;
  plot.title = title;
  plot.subtitle = "Each curve is one method refined in dx. One thread, CPU time of the steps";
  plot.x_label = "CPU time [s]";
  plot.y_label = error;
  plot.series =
      curves(rows, [&](const AccuracyRow& r) { return r.problem == problem && choose(r); });
  std::vector<PlotPoint> points;
  for (const PlotSeries& s : plot.series)
    points.insert(points.end(), s.points.begin(), s.points.end());
  plot.front = pareto_front(points);
  plot.front_label = "Pareto front";
  return plot;
}

// In three dimensions a run costs 1 / dx^4, so that order n in dx has slope -n/4.
void add_order_guides(LogPlot& plot) {
  if (plot.front.empty()) return;
  const PlotPoint at = plot.front.front();
  plot.guides = {{"order 1 in dx", -0.25, at.x, 0.75 * at.y},
                 {"order 2 in dx", -0.5, at.x, 0.75 * at.y}};
}

bool plain_step(const AccuracyRow& row) {
  return row.courant == 0.2 || row.courant == 0.3 || std::isnan(row.courant);
}

LogPlot column_plot(const std::vector<AccuracyRow>& rows) {
  LogPlot plot;
  plot.name = "accuracy_float";
  plot.title = "Where float ends: a wave in one dimension, APIC";
  plot.subtitle = "Error of the displacement over its amplitude A. Float is the tile solver";
  plot.x_label = "cells a unit length";
  plot.y_label = "relative error of u";
  for (const char* problem : {"column_4e-3", "column_1e-4"}) {
    const bool large = problem == std::string("column_4e-3");
    for (PlotSeries& s : curves(
             rows, [&](const AccuracyRow& r) { return r.problem == problem; }, true)) {
      s.label = fmt::format("A = {}, {}", large ? "0.004" : "0.0001",
                            s.marker == Marker::ring ? "float" : "double");
      s.color = large ? 0x2166ac : 0xc0504d;
      plot.series.push_back(s);
    }
    PlotSeries rounding;
    rounding.label = fmt::format("A = {}, float - double", large ? "0.004" : "0.0001");
    rounding.color = large ? 0x2166ac : 0xc0504d;
    rounding.dashed = true;
    rounding.marker = Marker::none;
    for (const AccuracyRow& r : rows)
      if (r.problem == problem && std::isfinite(r.rounding))
        rounding.points.push_back({static_cast<Real>(r.cells), r.rounding, 0, 0});
    plot.series.push_back(rounding);
  }
  if (!plot.series.empty() && !plot.series[0].points.empty()) {
    const PlotPoint at = plot.series[0].points[0];
    plot.guides = {{"order 1", -1, at.x, 0.7 * at.y}, {"order 2", -2, at.x, 0.7 * at.y}};
  }
  return plot;
}

}  // namespace

std::vector<LogPlot> accuracy_plots(const std::vector<AccuracyRow>& rows) {
  std::vector<LogPlot> out;
  out.push_back(work_plot(rows, "wave", plain_step, "Manufactured wave in a cube (P1)",
                          "relative error of u"));
  add_order_guides(out.back());
  out.push_back(work_plot(rows, "large_wave", plain_step, "The same with strains of 16 % (P1)",
                          "relative error of u"));
  add_order_guides(out.back());
  out.push_back(work_plot(rows, "turning_ball", plain_step, "A ball turns by an eighth (P2)",
                          "lost share of the mechanical energy"));
  out.push_back(work_plot(rows, "colliding_balls", plain_step, "Two balls collide (P3)",
                          "lost share of the mechanical energy"));
  for (const char* problem : {"driven_rankine", "driven_von_mises"}) {
    out.push_back(work_plot(rows, problem, plain_step, "A path through yield and softening (P4)",
                            "error of the stress"));
    out.back().subtitle = "Each curve is one method in 20 to 1280 steps. One thread, CPU time";
  }
  out.push_back(
      work_plot(rows, "torn_bar", plain_step, "A bar is torn (P5)", "error of the crack's energy"));
  out.push_back(work_plot(rows, "taylor_bar", plain_step, "A copper bar hits a wall (P6)",
                          "mean error of length and foot"));
  out.push_back(column_plot(rows));
  std::erase_if(out, [](const LogPlot& plot) {
    return std::all_of(plot.series.begin(), plot.series.end(),
                       [](const PlotSeries& s) { return s.points.empty(); });
  });
  return out;
}

}  // namespace rend
