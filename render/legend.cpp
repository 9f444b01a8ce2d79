// The colour bar in the corner of a picture.
#include "render/legend.h"

#include "render/color_map.h"
#include "render/stroke_font.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace rend {

namespace {

/// Blends a rectangle with round corners; `color(t)` is the display colour at the share t of its
/// width.
template <class Color>
void fill_rounded(Image& image, float left, float top, float width, float height, float radius,
                  float alpha, const Color& color) {
  const int x0 = std::max(0, static_cast<int>(left) - 1),
            x1 = std::min(image.width - 1, static_cast<int>(left + width) + 1);
  const int y0 = std::max(0, static_cast<int>(top) - 1),
            y1 = std::min(image.height - 1, static_cast<int>(top + height) + 1);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
      const float dx = std::abs(px - left - width / 2) - width / 2 + radius;
      const float dy = std::abs(py - top - height / 2) - height / 2 + radius;
      const float outside = std::hypot(std::max(dx, 0.0f), std::max(dy, 0.0f)) +
                            std::min(std::max(dx, dy), 0.0f) - radius;
      const float ink = alpha * std::clamp(0.5f - outside, 0.0f, 1.0f);
      if (ink <= 0) continue;
      const Rgb ours = color((px - left) / width);
      std::uint8_t* const pixel =
          &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                          static_cast<std::size_t>(x))];
      for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>(static_cast<float>(pixel[c]) * (1 - ink) +
                                             ours[c] * 255 * ink + 0.5f);
    }
}

}  // namespace

std::vector<float> round_labels(float low, float high) {
  if (!(high > low) || !std::isfinite(high - low)) return {low};
  const double span = static_cast<double>(high) - low,
               decade = std::pow(10, std::floor(std::log10(span)) - 1);
  std::vector<float> best;
  for (const std::size_t want : {3u, 4u, 2u})
    for (const double step : {50.0, 40.0, 25.0, 20.0, 10.0, 5.0, 4.0, 2.5, 2.0}) {
      const double size = step * decade, slack = 1e-6 * span;
      std::vector<float> labels;
      for (double k = std::ceil((low - slack) / size);
           k * size <= high + slack && labels.size() < 9; ++k)
        labels.push_back(static_cast<float>(k * size));
      if (labels.size() == want) return labels;
      if (best.empty() && labels.size() > 1) best = labels;
    }
  return best.empty() ? std::vector<float>{low, high} : best;
}

void draw_legend(Image& image, const Coloring& coloring, Theme theme) {
  const bool scale = coloring.map == ColorMap::damage || coloring.map == ColorMap::cividis;
  const float size = std::clamp(
      std::min(static_cast<float>(image.width) / 1280, static_cast<float>(image.height) / 720),
      0.62f, 8.0f);
  if (coloring.caption.empty() || !scale || image.width < 260 || image.height < 160) return;
  const bool dark = theme == Theme::dark;
  const Rgb ink = hex_color(dark ? 0xe8eaed : 0x1b1f24),
            card = hex_color(dark ? 0x23272d : 0xffffff);

  const float letter = 9.2f * size, pad = 14 * size, bar_height = 8 * size;
  const float bar_width = std::max(170 * size, text_width(coloring.caption, letter));
  const float width = bar_width + 2 * pad, height = 2 * pad + 2 * letter + bar_height + 18 * size;
  const float left = static_cast<float>(image.width) - width - 20 * size;
  const float top = static_cast<float>(image.height) - height - 20 * size;
  fill_rounded(image, left, top, width, height, 10 * size, 0.72f, [&](float) { return card; });

  const float bar_left = left + pad, bar_top = top + pad + letter + 9 * size;
  draw_text(image, coloring.caption, bar_left, top + pad + letter, letter, ink);
  fill_rounded(image, bar_left, bar_top, bar_width, bar_height, bar_height / 2, 1,
               [&](float t) { return ramp_color(coloring.map, t); });
  const float span = coloring.high - coloring.low;
  for (const float value : round_labels(coloring.low, coloring.high)) {
    const std::string text = fmt::format("{:.4g}", value == 0 ? 0.0f : value);
    const float wide = text_width(text, letter),
                place = span > 0 ? (value - coloring.low) / span : 0;
    // The outer labels end with the bar instead of sticking out.
    const float x = std::clamp(place * bar_width - wide / 2, 0.0f, bar_width - wide);
    draw_text(image, text, bar_left + x, bar_top + bar_height + 9 * size + letter, letter, ink);
  }
}

}  // namespace rend
