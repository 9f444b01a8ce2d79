// Axes, guides, series and legend.
#include "bench/log_plot.h"

#include "bench/plot_canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

constexpr float kWidth = 860, kHeight = 540, kLeft = 76, kRight = 612, kTop = 78, kBottom = 478;
constexpr std::uint32_t kInk = 0x1b1f24, kQuiet = 0x656c76, kGrid = 0xe4e7eb, kCard = 0xffffff,
                        kRim = 0xd4d9df, kFront = 0xf7d98b, kGuide = 0xa9b0b9;

bool shown(const PlotPoint& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0 && p.y > 0;
}

// One logarithmic axis, in decades.
struct Axis {
  Real low = 1e300, high = -1e300;
  float from = 0, to = 0;

  void add(Real value) {
    low = std::min(low, std::log10(value));
    high = std::max(high, std::log10(value));
  }
  void pad() {
    if (low > high) low = high = 0;
    const Real room = std::max(0.06 * (high - low), 0.08);
    low -= room;
    high += room;
  }
  float at(Real value) const {
    return from + static_cast<float>((std::log10(value) - low) / (high - low)) * (to - from);
  }
  std::vector<Real> ticks() const {
    std::vector<Real> out;
    const std::vector<int> digits =
        high - low > 2.2 ? std::vector<int>{1} : std::vector<int>{1, 2, 5};
    for (int decade = static_cast<int>(std::floor(low)); decade <= high; ++decade)
      for (int digit : digits) {
        const Real value = digit * std::pow(10.0, decade), place = std::log10(value);
        if (place >= low && place <= high) out.push_back(value);
      }
    return out;
  }
};

struct Frame {
  Axis x, y;
  PlotXY at(const PlotPoint& p) const { return {x.at(p.x), y.at(p.y)}; }
};

Frame make_frame(const LogPlot& plot) {
  Frame frame;
  for (const PlotSeries& s : plot.series)
    for (const PlotPoint& p : s.points) {
      if (!shown(p)) continue;
      frame.x.add(p.x);
      frame.y.add(p.y);
      if (p.low > 0) frame.y.add(p.low);
      if (p.high > 0) frame.y.add(p.high);
    }
  frame.x.from = kLeft, frame.x.to = kRight;
  frame.y.from = kBottom, frame.y.to = kTop;
  frame.x.pad();
  frame.y.pad();
  return frame;
}

void draw_axes(PlotCanvas& canvas, const LogPlot& plot, const Frame& frame) {
  canvas.rectangle({0, 0}, {kWidth, kHeight}, kCard);
  canvas.line({{0.5f, 0.5f},
               {kWidth - 0.5f, 0.5f},
               {kWidth - 0.5f, kHeight - 0.5f},
               {0.5f, kHeight - 0.5f},
               {0.5f, 0.5f}},
              kRim, 1, false);
  canvas.text({24, 30}, plot.title, 11.5f, kInk, Anchor::start);
  canvas.text({24, 49}, plot.subtitle, 8.5f, kQuiet, Anchor::start);
  for (Real value : frame.x.ticks()) {
    const float x = frame.x.at(value);
    canvas.line({{x, kTop}, {x, kBottom}}, kGrid, 1, false);
    canvas.text({x, kBottom + 18}, fmt::format("{:g}", value), 8, kQuiet, Anchor::middle);
  }
  for (Real value : frame.y.ticks()) {
    const float y = frame.y.at(value);
    canvas.line({{kLeft, y}, {kRight, y}}, kGrid, 1, false);
    canvas.text({kLeft - 8, y + 4}, fmt::format("{:g}", value), 8, kQuiet, Anchor::end);
  }
  canvas.text({0.5f * (kLeft + kRight), kBottom + 42}, plot.x_label, 9, kInk, Anchor::middle);
  canvas.text({24, kTop - 10}, plot.y_label, 9, kInk, Anchor::start);
}

void draw_guide(PlotCanvas& canvas, const Frame& frame, const PlotGuide& guide) {
  // Clipped to the plot in decades.
  const Real x = std::log10(guide.x), y = std::log10(guide.y);
  Real from = frame.x.low, to = frame.x.high;
  if (guide.slope != 0) {
    const Real a = x + (frame.y.low - y) / guide.slope, b = x + (frame.y.high - y) / guide.slope;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  if (from >= to) return;
  const auto at = [&](Real decade) {
    return frame.at({std::pow(10.0, decade), std::pow(10.0, y + guide.slope * (decade - x)), 0, 0});
  };
  canvas.line({at(from), at(to)}, kGuide, 1.2f, true);
  const PlotXY end = guide.slope > 0 ? at(from) : at(to);
  const bool at_right = guide.slope <= 0;
  canvas.text({end[0] + (at_right ? -6.0f : 6.0f), end[1] - 7}, guide.label, 8, kQuiet,
              at_right ? Anchor::end : Anchor::start);
}

void draw_marker(PlotCanvas& canvas, PlotXY at, Marker marker, std::uint32_t color) {
  const float r = 4.2f;
  if (marker == Marker::disc) canvas.circle(at, r, color, 0);
  if (marker == Marker::ring) canvas.circle(at, r - 0.6f, color, 2);
  if (marker == Marker::square) canvas.rectangle({at[0] - 3.7f, at[1] - 3.7f}, {7.4f, 7.4f}, color);
  // A heavy pen fills a small diamond.
  const bool full = marker == Marker::full_diamond;
  if (!full && marker != Marker::diamond) return;
  const float d = full ? 2.2f : r;
  canvas.line({{at[0] - d, at[1]},
               {at[0], at[1] - d},
               {at[0] + d, at[1]},
               {at[0], at[1] + d},
               {at[0] - d, at[1]}},
              color, full ? 4.4f : 2, false);
}

void draw_series(PlotCanvas& canvas, const Frame& frame, const PlotSeries& series) {
  std::vector<PlotXY> points;
  for (const PlotPoint& p : series.points) {
    if (!shown(p)) continue;
    points.push_back(frame.at(p));
    if (!(p.low > 0) || !(p.high > p.low)) continue;
    const float x = points.back()[0], low = frame.y.at(p.low), high = frame.y.at(p.high);
    canvas.line({{x, low}, {x, high}}, series.color, 1.3f, false);
    for (float y : {low, high}) canvas.line({{x - 4, y}, {x + 4, y}}, series.color, 1.3f, false);
  }
  if (series.joined) canvas.line(points, series.color, 1.6f, series.dashed);
  for (const PlotXY& p : points) draw_marker(canvas, p, series.marker, series.color);
}

void draw(const LogPlot& plot, PlotCanvas& canvas) {
  const Frame frame = make_frame(plot);
  draw_axes(canvas, plot, frame);
  for (const PlotGuide& guide : plot.guides) draw_guide(canvas, frame, guide);
  std::vector<PlotXY> front;
  for (const PlotPoint& p : plot.front) front.push_back(frame.at(p));
  if (front.size() == 1) front.push_back(front[0]);
  canvas.line(front, kFront, 9, false);
  for (const PlotSeries& series : plot.series) draw_series(canvas, frame, series);

  float y = kTop + 8;
  const float x = kRight + 22;
  for (const PlotSeries& series : plot.series) {
    if (series.label.empty()) continue;
    if (series.joined) canvas.line({{x, y}, {x + 26, y}}, series.color, 1.6f, series.dashed);
    draw_marker(canvas, {x + 13, y}, series.marker, series.color);
    canvas.text({x + 36, y + 4}, series.label, 8, kInk, Anchor::start);
    y += 19;
  }
  if (plot.front.empty()) return;
  canvas.line({{x + 4, y}, {x + 22, y}}, kFront, 9, false);
  canvas.text({x + 36, y + 4}, plot.front_label, 8, kInk, Anchor::start);
}

}  // namespace

std::vector<PlotPoint> pareto_front(std::vector<PlotPoint> points) {
  std::erase_if(points, [](const PlotPoint& p) { return !shown(p); });
  std::sort(points.begin(), points.end(), [](const PlotPoint& a, const PlotPoint& b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
  });
  std::vector<PlotPoint> front;
  for (const PlotPoint& p : points)
    if (front.empty() || p.y < front.back().y) front.push_back(p);
  return front;
}

std::string plot_svg(const LogPlot& plot) {
  SvgCanvas canvas(kWidth, kHeight);
  draw(plot, canvas);
  return canvas.finish();
}

Image plot_image(const LogPlot& plot, float scale) {
  ImageCanvas canvas(kWidth, kHeight, scale);
  draw(plot, canvas);
  return std::move(canvas).finish();
}

}  // namespace rend
