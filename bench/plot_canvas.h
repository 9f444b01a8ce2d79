// What plots are drawn on: a few shapes, kept as SVG text or as pixels.
#pragma once

#include "render/renderer.h"

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rend {

using PlotXY = std::array<float, 2>;

enum class Anchor { start, middle, end };

/// Units are those of the SVG, y runs down; colours 0xrrggbb.
class PlotCanvas {
 public:
  virtual ~PlotCanvas() = default;
  /// A polyline with round ends.
  virtual void line(const std::vector<PlotXY>& points, std::uint32_t color, float width,
                    bool dashed) = 0;
  /// width 0 fills.
  virtual void circle(PlotXY centre, float radius, std::uint32_t color, float width) = 0;
  virtual void rectangle(PlotXY low, PlotXY size, std::uint32_t color) = 0;
  /// Capitals `height` tall, (x, y) on the baseline.
  virtual void text(PlotXY at, std::string_view text, float height, std::uint32_t color,
                    Anchor anchor) = 0;
};

class SvgCanvas : public PlotCanvas {
 public:
  SvgCanvas(float width, float height);
  void line(const std::vector<PlotXY>&, std::uint32_t, float, bool) override;
  void circle(PlotXY, float, std::uint32_t, float) override;
  void rectangle(PlotXY, PlotXY, std::uint32_t) override;
  void text(PlotXY, std::string_view, float, std::uint32_t, Anchor) override;
  std::string finish() const { return out_ + "</svg>\n"; }

 private:
  std::string out_;
};

class ImageCanvas : public PlotCanvas {
 public:
  ImageCanvas(float width, float height, float scale);
  void line(const std::vector<PlotXY>&, std::uint32_t, float, bool) override;
  void circle(PlotXY, float, std::uint32_t, float) override;
  void rectangle(PlotXY, PlotXY, std::uint32_t) override;
  void text(PlotXY, std::string_view, float, std::uint32_t, Anchor) override;
  Image finish() && { return std::move(image_); }

 private:
  /// Blends `color` by the share that ink(x, y) of each pixel centre in the box gives.
  template <class Ink>
  void blend(float x0, float y0, float x1, float y1, std::uint32_t color, const Ink& ink);
  void stroke(PlotXY a, PlotXY b, std::uint32_t color, float width);

  Image image_;
  float scale_;
};

}  // namespace rend
