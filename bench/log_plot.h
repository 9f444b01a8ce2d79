// Log-log plots of studies, as SVG and as pixels.
#pragma once

#include "engine/core/types.h"
#include "render/renderer.h"

#include <string>
#include <vector>

namespace rend {

enum class Marker { none, disc, ring, square, diamond, full_diamond };

struct PlotPoint {
  Real x = 0, y = 0;
  Real low = 0, high = 0;  ///< error bar; none when both are 0
};

/// Points joined by a line in their order. Points without positive finite coordinates are left out.
struct PlotSeries {
  std::string label;        ///< in the legend; empty: not there
  std::uint32_t color = 0;  ///< 0xrrggbb
  Marker marker = Marker::disc;
  bool joined = true, dashed = false;
  std::vector<PlotPoint> points;
};

/// A straight line of `slope` decades a decade through (x, y), as wide as the plot.
struct PlotGuide {
  std::string label;
  Real slope = 1, x = 1, y = 1;
};

struct LogPlot {
  std::string name;  ///< file name without ending
  std::string title, subtitle, x_label, y_label;
  std::vector<PlotSeries> series;
  std::vector<PlotPoint> front;  ///< emphasised, from left to right
  std::string front_label;
  std::vector<PlotGuide> guides;
};

/// Members that no other beats in both coordinates, from left to right.
std::vector<PlotPoint> pareto_front(std::vector<PlotPoint> points);

/// A picture of its own: light card, fonts of the reader.
std::string plot_svg(const LogPlot& plot);

/// The same drawing with `scale` pixels a unit of the SVG.
Image plot_image(const LogPlot& plot, float scale = 1.5f);

}  // namespace rend
