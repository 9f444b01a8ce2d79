// Plots as pixels, antialiased by the distance to each shape.
#include "bench/plot_canvas.h"

#include "render/stroke_font.h"

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

Rgb display_color(std::uint32_t hex) {
  return {static_cast<float>(hex >> 16 & 255) / 255, static_cast<float>(hex >> 8 & 255) / 255,
          static_cast<float>(hex & 255) / 255};
}

}  // namespace

ImageCanvas::ImageCanvas(float width, float height, float scale) : scale_(scale) {
  image_.width = static_cast<int>(std::lround(width * scale));
  image_.height = static_cast<int>(std::lround(height * scale));
  image_.rgb.assign(
      3 * static_cast<std::size_t>(image_.width) * static_cast<std::size_t>(image_.height), 255);
}

template <class Ink>
void ImageCanvas::blend(float x0, float y0, float x1, float y1, std::uint32_t color,
                        const Ink& ink) {
  const Rgb ours = display_color(color);
  const int left = std::max(0, static_cast<int>(x0) - 1),
            right = std::min(image_.width - 1, static_cast<int>(x1) + 1);
  const int top = std::max(0, static_cast<int>(y0) - 1),
            bottom = std::min(image_.height - 1, static_cast<int>(y1) + 1);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const float share =
          std::clamp(ink(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f), 0.0f, 1.0f);
      if (share <= 0) continue;
      std::uint8_t* const pixel =
          &image_.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
                           static_cast<std::size_t>(x))];
      for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>(static_cast<float>(pixel[c]) * (1 - share) +
                                             ours[c] * 255 * share + 0.5f);
    }
}

void ImageCanvas::stroke(PlotXY a, PlotXY b, std::uint32_t color, float width) {
  for (PlotXY* p : {&a, &b})
    for (float& v : *p) v *= scale_;
  const float half = 0.5f * width * scale_, dx = b[0] - a[0], dy = b[1] - a[1];
  const float length2 = dx * dx + dy * dy;
  blend(std::min(a[0], b[0]) - half, std::min(a[1], b[1]) - half, std::max(a[0], b[0]) + half,
        std::max(a[1], b[1]) + half, color, [&](float x, float y) {
          const float along = (x - a[0]) * dx + (y - a[1]) * dy;
          const float t = length2 > 0 ? std::clamp(along / length2, 0.0f, 1.0f) : 0;
          return half + 0.5f - std::hypot(x - a[0] - t * dx, y - a[1] - t * dy);
        });
}

void ImageCanvas::line(const std::vector<PlotXY>& points, std::uint32_t color, float width,
                       bool dashed) {
  constexpr float kDash = 6, kGap = 5;
  float phase = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const PlotXY a = points[i - 1], b = points[i];
    const float length = std::hypot(b[0] - a[0], b[1] - a[1]);
    const auto at = [&](float s) {
      const float t = length > 0 ? s / length : 0;
      return PlotXY{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
    };
    if (!dashed) {
      stroke(a, b, color, width);
      continue;
    }
    for (float s = -phase; s < length; s += kDash + kGap)
      if (s + kDash > 0)
        stroke(at(std::max(s, 0.0f)), at(std::min(s + kDash, length)), color, width);
    phase = std::fmod(phase + length, kDash + kGap);
  }
}

void ImageCanvas::circle(PlotXY centre, float radius, std::uint32_t color, float width) {
  const float cx = centre[0] * scale_, cy = centre[1] * scale_;
  const auto disc = [&](float r, std::uint32_t shade) {
    blend(cx - r, cy - r, cx + r, cy + r, shade,
          [&](float x, float y) { return r + 0.5f - std::hypot(x - cx, y - cy); });
  };
  disc((radius + 0.5f * width) * scale_, color);
  if (width > 0) disc((radius - 0.5f * width) * scale_, 0xffffff);
}

void ImageCanvas::rectangle(PlotXY low, PlotXY size, std::uint32_t color) {
  const float x0 = low[0] * scale_, y0 = low[1] * scale_, x1 = x0 + size[0] * scale_,
              y1 = y0 + size[1] * scale_;
  blend(x0, y0, x1, y1, color, [&](float x, float y) {
    return std::min({x - x0, x1 - x, 0.5f}) + std::min({y - y0, y1 - y, 0.5f});
  });
}

void ImageCanvas::text(PlotXY at, std::string_view text, float height, std::uint32_t color,
                       Anchor anchor) {
  const float size = height * scale_;
  const float share = anchor == Anchor::start ? 0 : anchor == Anchor::middle ? 0.5f : 1.0f;
  draw_text(image_, text, at[0] * scale_ - share * text_width(text, size), at[1] * scale_, size,
            display_color(color));
}

}  // namespace rend
