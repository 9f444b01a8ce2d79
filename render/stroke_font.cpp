// Glyphs as pen strokes: capitals are 7 units tall, small letters 5, the baseline is y = 0.
#include "render/stroke_font.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <vector>

namespace rend {

namespace {

/// `path`: "M x y" moves, "L x y" draws a line, "A cx cy rx ry from to" draws an arc of an ellipse,
/// angles in degrees, joined to the stroke before it unless that was closed by "|".
struct Glyph {
  std::uint32_t code;
  float width;
  const char* path;
};

constexpr float kCapital = 7, kGap = 1.9f, kSpace = 2.3f, kPen = 1.0f;

constexpr Glyph kGlyphs[] = {
    {'0', 4.2f, "A2.1 3.5 2.1 3.5 0 360"},
    {'1', 2.8f, "M0.3 5.3 L2.1 7 L2.1 0"},
    {'2', 4.1f, "A2 5 1.95 2 165 -30 L0.1 0 L4.1 0"},
    {'3', 4.1f, "A2 5.3 1.8 1.7 150 -90 | A2 1.8 2.1 1.8 90 -150"},
    {'4', 4.4f, "M3.3 0 L3.3 7 L0 2 L4.4 2"},
    {'5', 4.1f, "M3.8 7 L0.75 7 L0.4 3.75 A2 2.3 2.1 2.3 139 -150"},
    {'6', 4.2f, "A2.1 2.25 2.1 2.25 0 360 | A3.3 2.4 3.3 4.6 180 78"},
    {'7', 4.1f, "M0 7 L4.1 7 L1.4 0"},
    {'8', 4.2f, "A2.1 5.3 1.75 1.7 0 360 | A2.1 1.8 2.1 1.8 0 360"},
    {'9', 4.2f, "A2.1 4.75 2.1 2.25 0 360 | A0.9 4.6 3.3 4.6 0 -102"},
    {'A', 5.4f, "M0 0 L2.7 7 L5.4 0 M0.9 2.2 L4.5 2.2"},
    {'B', 4.5f,
     "M0 3.6 L0 7 L2.3 7 A2.3 5.3 1.8 1.7 90 -90 L0 3.6 L0 0 L2.5 0 A2.5 1.8 2 1.8 -90 90 L0 3.6"},
    {'C', 5.2f, "A3 3.5 3 3.5 46 314"},
    {'D', 5.1f, "M0 0 L0 7 L1.9 7 A1.9 3.5 3.2 3.5 90 -90 L0 0"},
    {'E', 4.1f, "M4 7 L0 7 L0 0 L4.1 0 M0 3.6 L3.6 3.6"},
    {'F', 4.0f, "M4 7 L0 7 L0 0 M0 3.6 L3.5 3.6"},
    {'G', 5.7f, "A3 3.5 3 3.5 46 335 L5.72 3.3 L3.4 3.3"},
    {'H', 5.0f, "M0 0 L0 7 M5 0 L5 7 M0 3.6 L5 3.6"},
    {'I', 0.0f, "M0 0 L0 7"},
    {'J', 3.0f, "M3 7 L3 1.8 A1.5 1.8 1.5 1.8 0 -165"},
    {'K', 4.8f, "M0 0 L0 7 M4.6 7 L0 2.4 M1.6 4 L4.8 0"},
    {'L', 3.8f, "M0 7 L0 0 L3.8 0"},
    {'M', 6.0f, "M0 0 L0 7 L3 1.5 L6 7 L6 0"},
    {'N', 5.0f, "M0 0 L0 7 L5 0 L5 7"},
    {'O', 6.2f, "A3.1 3.5 3.1 3.5 0 360"},
    {'P', 4.4f, "M0 0 L0 7 L2.4 7 A2.4 5.05 2 1.95 90 -90 L0 3.1"},
    {'Q', 6.2f, "A3.1 3.5 3.1 3.5 0 360 M3.8 1.7 L5.9 -0.5"},
    {'R', 4.6f, "M0 0 L0 7 L2.4 7 A2.4 5.05 2 1.95 90 -90 L0 3.1 M2.4 3.1 L4.6 0"},
    {'S', 4.4f, "A2.2 5.25 2 1.75 38 270 | A2.2 1.75 2.2 1.75 90 -152"},
    {'T', 5.0f, "M0 7 L5 7 M2.5 7 L2.5 0"},
    {'U', 5.0f, "M0 7 L0 2.5 A2.5 2.5 2.5 2.5 180 360 L5 7"},
    {'V', 5.4f, "M0 7 L2.7 0 L5.4 7"},
    {'W', 7.8f, "M0 7 L1.95 0 L3.9 7 L5.85 0 L7.8 7"},
    {'X', 4.9f, "M0 7 L4.9 0 M4.9 7 L0 0"},
    {'Y', 5.0f, "M0 7 L2.5 3.2 L5 7 M2.5 3.2 L2.5 0"},
    {'Z', 4.6f, "M0 7 L4.5 7 L0 0 L4.6 0"},
    {'a', 3.9f, "A1.95 2.5 1.95 2.5 0 360 M3.9 5 L3.9 0"},
    {'b', 3.9f, "A1.95 2.5 1.95 2.5 0 360 M0 7.2 L0 0"},
    {'c', 3.5f, "A1.95 2.5 1.95 2.5 48 312"},
    {'d', 3.9f, "A1.95 2.5 1.95 2.5 0 360 M3.9 7.2 L3.9 0"},
    {'e', 3.9f, "M0 2.6 L3.9 2.6 A1.95 2.5 1.95 2.5 2 318"},
    {'f', 2.4f, "M0.9 0 L0.9 5.7 A2.3 5.7 1.4 1.5 180 85 M0 4.8 L2.3 4.8"},
    {'g', 3.9f, "A1.95 2.5 1.95 2.5 0 360 M3.9 5 L3.9 -0.3 A1.95 -0.3 1.95 1.8 0 -150"},
    {'h', 3.7f, "M0 7.2 L0 0 M0 3.1 A1.85 3.1 1.85 1.9 180 0 L3.7 0"},
    {'i', 0.0f, "M0 0 L0 5 M0 6.8 L0 6.8"},
    {'j', 0.6f, "M0.6 5 L0.6 -0.8 A-0.5 -0.8 1.1 1.1 0 -90 M0.6 6.8 L0.6 6.8"},
    {'k', 3.6f, "M0 7.2 L0 0 M3.4 5 L0 1.8 M1.3 3.1 L3.6 0"},
    {'l', 0.0f, "M0 7.2 L0 0"},
    {'m', 6.0f, "M0 5 L0 0 M0 3.4 A1.5 3.4 1.5 1.6 180 0 L3 0 M3 3.4 A4.5 3.4 1.5 1.6 180 0 L6 0"},
    {'n', 3.7f, "M0 5 L0 0 M0 3.1 A1.85 3.1 1.85 1.9 180 0 L3.7 0"},
    {'o', 4.0f, "A2 2.5 2 2.5 0 360"},
    {'p', 3.9f, "A1.95 2.5 1.95 2.5 0 360 M0 5 L0 -2"},
    {'q', 3.9f, "A1.95 2.5 1.95 2.5 0 360 M3.9 5 L3.9 -2"},
    {'r', 2.2f, "M0 5 L0 0 M0 2.9 A1.9 2.9 1.9 2.1 180 82"},
    {'s', 3.3f, "A1.65 3.75 1.5 1.25 38 270 | A1.65 1.25 1.65 1.25 90 -150"},
    {'t', 2.4f, "M0.95 6.5 L0.95 1.3 A2.2 1.3 1.25 1.3 180 280 M0 4.9 L2.3 4.9"},
    {'u', 3.7f, "M0 5 L0 1.9 A1.85 1.9 1.85 1.9 180 360 M3.7 5 L3.7 0"},
    {'v', 3.8f, "M0 5 L1.9 0 L3.8 5"},
    {'w', 5.8f, "M0 5 L1.45 0 L2.9 5 L4.35 0 L5.8 5"},
    {'x', 3.6f, "M0 5 L3.6 0 M3.6 5 L0 0"},
    {'y', 3.8f, "M0 5 L1.9 0.2 M3.8 5 L1.5 -1.3 L0.3 -2"},
    {'z', 3.5f, "M0 5 L3.4 5 L0 0 L3.5 0"},
    {'.', 0.0f, "M0 0 L0 0"},
    {',', 0.3f, "M0.3 0.1 L0 -1.2"},
    {':', 0.0f, "M0 0.2 L0 0.2 M0 4.2 L0 4.2"},
    {'-', 2.4f, "M0 2.7 L2.4 2.7"},
    {'+', 3.6f, "M0 2.9 L3.6 2.9 M1.8 1.1 L1.8 4.7"},
    {'=', 3.6f, "M0 2.1 L3.6 2.1 M0 3.8 L3.6 3.8"},
    {'/', 2.6f, "M0 -0.8 L2.6 7.6"},
    {'(', 1.3f, "M1.3 8 A3 3.3 3 5.4 122 238"},
    {')', 1.3f, "A-1.7 3.3 3 5.4 58 -58"},
    {'[', 1.2f, "M1.2 8 L0 8 L0 -1.2 L1.2 -1.2"},
    {']', 1.2f, "M0 8 L1.2 8 L1.2 -1.2 L0 -1.2"},
    {'%', 6.2f, "A1.3 5.5 1.3 1.5 0 360 | A4.9 1.5 1.3 1.5 0 360 M4.9 7 L1.3 0"},
    {'_', 4.0f, "M0 -1 L4 -1"},
    {'\'', 0.0f, "M0 7.2 L0 5.4"},
    {0xb2, 2.2f, "A1.1 6.7 1.05 1.1 165 -30 L0 4 L2.2 4"},
    {0xb3, 2.2f, "A1.1 7 0.95 0.8 150 -90 | A1.1 5.1 1.1 1.1 90 -150"},
    {0xb5, 3.7f, "M0 5 L0 -2 M0 1.9 A1.85 1.9 1.85 1.9 180 360 M3.7 5 L3.7 0"},
    {0xb7, 0.0f, "M0 2.9 L0 2.9"},
    {0xd7, 3.2f, "M0 4.5 L3.2 1.3 M0 1.3 L3.2 4.5"},
    {0x3c4, 3.4f, "M0 5 L3.4 5 M1.6 5 L1.6 1.3 A2.7 1.3 1.1 1.3 180 285"},
    {0xfffd, 3.6f, "M0 0 L0 7 L3.6 7 L3.6 0 L0 0"},
};

struct Segment {
  float x0, y0, x1, y1;
};

const Glyph& find_glyph(std::uint32_t code) {
  for (const Glyph& glyph : kGlyphs)
    if (glyph.code == code) return glyph;
  return kGlyphs[std::size(kGlyphs) - 1];
}

/// Next code point of UTF-8 text; broken bytes give U+FFFD.
std::uint32_t next_code(std::string_view& text) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  const std::uint32_t lead = byte(0);
  const std::size_t length = lead < 0x80       ? 1
                             : lead >> 5 == 6  ? 2
                             : lead >> 4 == 14 ? 3
                             : lead >> 3 == 30 ? 4
                                               : 0;
  if (length == 0 || length > text.size()) {
    text.remove_prefix(1);
    return 0xfffd;
  }
  std::uint32_t code = length == 1 ? lead : lead & (0xffu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (byte(i) & 63);
  text.remove_prefix(length);
  return code;
}

std::vector<Segment> strokes(const Glyph& glyph) {
  std::vector<Segment> out;
  const char* p = glyph.path;
  float x = 0, y = 0;
  bool joined = false;
  const auto number = [&] {
    char* end = nullptr;
    const float value = std::strtof(p, &end);
    p = end;
    return value;
  };
  const auto go = [&](float to_x, float to_y) {
    if (joined) out.push_back({x, y, to_x, to_y});
    x = to_x, y = to_y;
    joined = true;
  };
  while (*p) {
    const char command = *p++;
    if (command == 'M' || command == '|') joined = false;
    if (command == 'M' || command == 'L') {
      const float to_x = number(), to_y = number();
      go(to_x, to_y);
    } else if (command == 'A') {
      const float cx = number(), cy = number(), rx = number(), ry = number(), from = number(),
                  to = number();
      const int steps = std::max(2, static_cast<int>(std::abs(to - from) / 12));
      for (int i = 0; i <= steps; ++i) {
        const float degrees =
            from + (to - from) * static_cast<float>(i) / static_cast<float>(steps);
        const float angle = degrees * std::numbers::pi_v<float> / 180;
        go(cx + rx * std::cos(angle), cy + ry * std::sin(angle));
      }
    }
  }
  return out;
}

float distance(const Segment& s, float x, float y) {
  const float dx = s.x1 - s.x0, dy = s.y1 - s.y0, length2 = dx * dx + dy * dy;
  const float t =
      length2 > 0 ? std::clamp(((x - s.x0) * dx + (y - s.y0) * dy) / length2, 0.0f, 1.0f) : 0;
  return std::hypot(x - s.x0 - t * dx, y - s.y0 - t * dy);
}

void draw_strokes(Image& image, const std::vector<Segment>& segments, float left, float baseline,
                  float unit, const Rgb& color) {
  float low_x = 1e9f, high_x = -1e9f, low_y = 1e9f, high_y = -1e9f;
  for (const Segment& s : segments) {
    low_x = std::min({low_x, s.x0, s.x1}), high_x = std::max({high_x, s.x0, s.x1});
    low_y = std::min({low_y, s.y0, s.y1}), high_y = std::max({high_y, s.y0, s.y1});
  }
  // Thin pens are kept at a width that still reads as ink.
  const float half_pen = 0.5f * std::max(kPen * unit, 1.15f), reach = half_pen + 1;
  const int x0 = std::max(0, static_cast<int>(left + low_x * unit - reach));
  const int x1 = std::min(image.width - 1, static_cast<int>(left + high_x * unit + reach));
  const int y0 = std::max(0, static_cast<int>(baseline - high_y * unit - reach));
  const int y1 = std::min(image.height - 1, static_cast<int>(baseline - low_y * unit + reach));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float gx = (static_cast<float>(x) + 0.5f - left) / unit,
                  gy = (baseline - static_cast<float>(y) - 0.5f) / unit;
      float nearest = 1e9f;
      for (const Segment& s : segments) nearest = std::min(nearest, distance(s, gx, gy));
      const float ink = std::clamp(half_pen - nearest * unit + 0.5f, 0.0f, 1.0f);
      if (ink <= 0) continue;
      std::uint8_t* const pixel =
          &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                          static_cast<std::size_t>(x))];
      for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>(static_cast<float>(pixel[c]) * (1 - ink) +
                                             color[c] * 255 * ink + 0.5f);
    }
}

}  // namespace

float text_width(std::string_view text, float height) {
  float width = 0;
  while (!text.empty()) {
    const std::uint32_t code = next_code(text);
    width += code == ' ' ? kSpace : find_glyph(code).width + kGap;
  }
  return std::max(0.0f, width - kGap) * height / kCapital;
}

void draw_text(Image& image, std::string_view text, float x, float y, float height,
               const Rgb& color) {
  const float unit = height / kCapital;
  while (!text.empty()) {
    const std::uint32_t code = next_code(text);
    if (code == ' ') {
      x += kSpace * unit;
      continue;
    }
    const Glyph& glyph = find_glyph(code);
    draw_strokes(image, strokes(glyph), x, y, unit, color);
    x += (glyph.width + kGap) * unit;
  }
}

}  // namespace rend
