// The studies in their smallest form: tables that programs can read, plots that browsers can draw.
#include "bench/bench_accuracy.h"
#include "bench/bench_cracks.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace rend;

namespace {

using Table = std::vector<std::vector<std::string>>;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(at, begin), text.size());
    out.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

Table read_csv(const std::string& text) {
  REQUIRE(text.ends_with('\n'));
  Table out;
  for (const std::string& line : split(text.substr(0, text.size() - 1), '\n'))
    out.push_back(split(line, ','));
  return out;
}

std::size_t column(const Table& table, const std::string& name) {
  const auto found = std::find(table[0].begin(), table[0].end(), name);
  REQUIRE(found != table[0].end());
  return static_cast<std::size_t>(found - table[0].begin());
}

// Every row as wide as the header; from column `first` on finite numbers or nothing.
void check_csv(const Table& table, const std::string& first) {
  const std::size_t begin = column(table, first);
  REQUIRE(table.size() > 1);
  for (std::size_t r = 1; r < table.size(); ++r) {
    REQUIRE(table[r].size() == table[0].size());
    for (std::size_t c = begin; c < table[r].size(); ++c) {
      if (table[r][c].empty()) continue;
      char* end = nullptr;
      const double value = std::strtod(table[r][c].c_str(), &end);
      CAPTURE(table[0][c]);
      CHECK(*end == 0);
      CHECK(std::isfinite(value));
    }
  }
}

// Tags close in order, text holds no bare < or &, coordinates are numbers.
void check_svg(const std::string& svg) {
  std::vector<std::string> open;
  for (std::size_t at = 0; (at = svg.find('<', at)) != std::string::npos;) {
    const std::size_t end = svg.find('>', at);
    REQUIRE(end != std::string::npos);
    const std::string tag = svg.substr(at + 1, end - at - 1);
    CHECK(tag.find('<') == std::string::npos);
    if (tag[0] == '/') {
      REQUIRE(!open.empty());
      CHECK(tag.substr(1) == open.back());
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      open.push_back(tag.substr(0, tag.find(' ')));
    }
    CHECK(std::count(tag.begin(), tag.end(), '"') % 2 == 0);
    at = end;
  }
  CHECK(open.empty());
  CHECK(svg.find("nan") == std::string::npos);
  CHECK(svg.find("inf") == std::string::npos);
}

const std::string kScenes = std::string(REND_SOURCE_DIR) + "/scenes";

}  // namespace

TEST_CASE("accuracy: CSV, table and plots of the smallest study") {
  const StudyOutput study = bench_accuracy(StudySize::smallest, kScenes);
  const Table table = read_csv(study.csv);
  check_csv(table, "dx");
  const std::size_t problem = column(table, "problem"), error = column(table, "error"),
                    status = column(table, "status"), cpu = column(table, "cpu_s");
  for (const char* name : {"wave", "column_4e-3", "turning_ball", "colliding_balls",
                           "driven_rankine", "driven_von_mises", "torn_bar"})
    CHECK(
        std::any_of(table.begin(), table.end(), [&](const auto& r) { return r[problem] == name; }));
  for (std::size_t r = 1; r < table.size(); ++r) {
    CHECK(table[r][status] == "ok");
    CHECK(std::atof(table[r][cpu].c_str()) > 0);
    CHECK(std::atof(table[r][error].c_str()) >= 0);
    CHECK(std::atof(table[r][error].c_str()) < 1.5);
  }
  CHECK(study.table.find("| wave | APIC") != std::string::npos);
  CHECK(study.plots.size() > 3);
  for (const LogPlot& plot : study.plots) {
    CAPTURE(plot.name);
    check_svg(plot_svg(plot));
  }
}

TEST_CASE("accuracy: the path of a driven block is exact but for rounding with the implicit rule") {
  AccuracyPlan plan;
  study_driven(StudySize::smallest, plan);
  for (const AccuracyRow& row : plan.run_all(nullptr, nullptr)) {
    const bool implicit_rule = row.rule == SofteningRule::implicit_rule;
    if (row.solver.deformation_update == DeformationUpdate::linear || !implicit_rule) {
      CHECK(row.error > 1e-6);
      continue;
    }
    const Real rounding = row.solver.precision == Precision::float32 ? 1e-4 : 1e-11;
    CHECK(row.error < rounding);
    CHECK(row.drift_energy < rounding);
    CHECK(row.y_max < rounding);
    CHECK(row.dissipation_min >= -rounding);
  }
}

TEST_CASE("cracks: CSV, table and plot of the smallest study") {
  const StudyOutput study = bench_cracks(StudySize::smallest, kScenes);
  const Table table = read_csv(study.csv);
  check_csv(table, "dx");
  CHECK(table.size() == 7);
  for (std::size_t r = 1; r < table.size(); ++r) {
    CHECK(std::atof(table[r][column(table, "dissipated")].c_str()) > 0);
    CHECK(std::atof(table[r][column(table, "failed")].c_str()) == 0);
  }
  REQUIRE(study.plots.size() == 1);
  check_svg(plot_svg(study.plots[0]));
}

TEST_CASE("statistics and curves of studies") {
  const Spread s = spread({1, 2, 3, 4});
  CHECK(s.mean == doctest::Approx(2.5));
  CHECK(s.deviation == doctest::Approx(std::sqrt(5.0 / 3)));

  // D = 7 dx^0.8
  std::vector<CrackRow> ensembles;
  for (Real dx : {0.4, 0.2, 0.1}) {
    CrackRow row;
    row.dx = dx;
    row.dissipated.mean = 7 * std::pow(dx, 0.8);
    ensembles.push_back(row);
  }
  CHECK(energy_slope(ensembles, ensembles[0]) == doctest::Approx(0.8));

  const std::vector<PlotPoint> front =
      pareto_front({{3, 1, 0, 0}, {1, 4, 0, 0}, {2, 5, 0, 0}, {2, 2, 0, 0}, {4, 1, 0, 0}});
  REQUIRE(front.size() == 3);
  CHECK(front[0].y == 4);
  CHECK(front[1].x == 2);
  CHECK(front[2].x == 3);

  // Cost 3 / error^2
  std::vector<AccuracyRow> rows(3);
  for (std::size_t i = 0; i < 3; ++i) {
    rows[i].error = std::pow(0.5, static_cast<Real>(i));
    rows[i].cost.cpu_seconds = 3 / (rows[i].error * rows[i].error);
  }
  CHECK(cost_at_error(rows, rows[0], 0.6) == doctest::Approx(3 / 0.36));
  CHECK(std::isnan(cost_at_error(rows, rows[0], 2)));
}

TEST_CASE("a plot as pixels: card, curve, label") {
  LogPlot plot;
  plot.title = "a < b & c";
  plot.x_label = "x";
  plot.y_label = "y";
  PlotSeries series;
  series.color = 0xff0000;
  series.points = {{1, 1, 0, 0}, {10, 0.1, 0.05, 0.2}, {100, -1, 0, 0}};
  plot.series = {series};
  plot.guides = {{"order 1", -1, 1, 0.5}};
  plot.front = pareto_front(series.points);
  check_svg(plot_svg(plot));
  const Image image = plot_image(plot, 1);
  REQUIRE(image.rgb.size() == 3u * static_cast<std::size_t>(image.width * image.height));
  int red = 0, white = 0, dark = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    const int r = image.rgb[i], g = image.rgb[i + 1], b = image.rgb[i + 2];
    red += r > 200 && g < 60 && b < 60;
    white += r == 255 && g == 255 && b == 255;
    dark += r < 80 && g < 80 && b < 80;
  }
  CHECK(red > 300);
  CHECK(dark > 50);
  CHECK(white > image.width * image.height / 2);
}
