// The legend: round labels, ink where it belongs.
#include "render/legend.h"

#include "render/color_map.h"
#include "render/stroke_font.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace rend;

TEST_CASE("labels are round numbers inside the range") {
  CHECK(round_labels(0, 1) == std::vector<float>{0, 0.5f, 1});
  CHECK(round_labels(0, 10) == std::vector<float>{0, 5, 10});
  CHECK(round_labels(0, 20) == std::vector<float>{0, 10, 20});
  CHECK(round_labels(-1, 1) == std::vector<float>{-1, 0, 1});
  CHECK(round_labels(2, 2).size() == 1);
  for (const float high : {0.0137f, 0.7f, 3.0f, 8731.0f, 6.4e7f}) {
    const auto labels = round_labels(0, high);
    CHECK(labels.size() >= 2);
    CHECK(labels.size() <= 4);
    for (const float label : labels) {
      CHECK(label >= 0);
      CHECK(label <= high * 1.00001f);
    }
  }
}

TEST_CASE("the legend changes its corner only, and only for maps with a scale") {
  const Image empty{640, 360, std::vector<std::uint8_t>(3 * 640 * 360, 200)};
  Coloring coloring;
  coloring.caption = "Stress [kPa]";
  Image image = empty;
  draw_legend(image, coloring, Theme::light);
  CHECK(image.rgb == empty.rgb);
  coloring.map = ColorMap::damage;
  draw_legend(image, coloring, Theme::light);
  int ink = 0;
  for (int y = 0; y < 360; ++y)
    for (int x = 0; x < 640; ++x) {
      const auto i = static_cast<std::size_t>(3 * (640 * y + x));
      if (image.rgb[i] == 200) continue;
      ++ink;
      CHECK_UNARY(x > 440);
      CHECK_UNARY(y > 280);
    }
  CHECK(ink > 3000);
}

TEST_CASE("text has width and ink, broken bytes and unknown characters too") {
  CHECK(text_width("", 10) == 0);
  CHECK(text_width("mm", 10) > text_width("il", 10));
  for (const char* text : {"Damage [m/s\xc2\xb2]", "\xff\xfe\xc2", "\xe6\xbc\xa2"}) {
    Image image{200, 40, std::vector<std::uint8_t>(3 * 200 * 40, 255)};
    draw_text(image, text, 10, 25, 12, {0, 0, 0});
    CHECK(std::count(image.rgb.begin(), image.rgb.end(), 0) > 10);
  }
  Image tiny{2, 2, std::vector<std::uint8_t>(12, 255)};
  draw_text(tiny, "outside", -50, 100, 12, {0, 0, 0});
  CHECK(std::count(tiny.rgb.begin(), tiny.rgb.end(), 255) == 12);
}

TEST_CASE("the damage ramp ends in the colours of the page and darkens all the way") {
  float last = 2;
  for (int i = 0; i <= 30; ++i) {
    const Rgb c = to_linear(ramp_color(ColorMap::damage, static_cast<float>(i) / 30));
    const float luminance = 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
    CHECK(luminance < last);
    last = luminance;
  }
  for (const auto& [t, hex] : {std::pair{0.0f, 0xe4ded2u}, {1.0f, 0x8f3518u}})
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(std::abs(ramp_color(ColorMap::damage, t)[c] - hex_color(hex)[c]) < 1 / 255.0f);
}
