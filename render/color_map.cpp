// Colours of fields.
#include "render/color_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace rend {

namespace {

constexpr unsigned kDamageStops[] = {kClay, 0xe8c87e, 0xd48838, 0x8f3518};
constexpr unsigned kCividisStops[] = {0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173,
                                      0x8a8678, 0xa59c74, 0xc3b369, 0xe1cc55, 0xfee838};

/// Linear sRGB to Oklab and back, coefficients by Ottosson.
Rgb to_oklab(const Rgb& c) {
  const float l = std::cbrt(0.4122214708f * c[0] + 0.5363325363f * c[1] + 0.0514459929f * c[2]);
  const float m = std::cbrt(0.2119034982f * c[0] + 0.6806995451f * c[1] + 0.1073969566f * c[2]);
  const float s = std::cbrt(0.0883024619f * c[0] + 0.2817188376f * c[1] + 0.6299787005f * c[2]);
  return {0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s,
          1.9779984951f * l - 2.4285922050f * m + 0.4505937099f * s,
          0.0259040371f * l + 0.7827717662f * m - 0.8086757660f * s};
}

Rgb from_oklab(const Rgb& lab) {
  const float l = lab[0] + 0.3963377774f * lab[1] + 0.2158037573f * lab[2];
  const float m = lab[0] - 0.1055613458f * lab[1] - 0.0638541728f * lab[2];
  const float s = lab[0] - 0.0894841775f * lab[1] - 1.2914855480f * lab[2];
  const float l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  return {4.0767416621f * l3 - 3.3077115913f * m3 + 0.2309699292f * s3,
          -1.2684380046f * l3 + 2.6097574011f * m3 - 0.3413193965f * s3,
          -0.0041960863f * l3 - 0.7034186147f * m3 + 1.7076147010f * s3};
}

}  // namespace

Rgb hex_color(unsigned rgb) {
  return {static_cast<float>(rgb >> 16 & 255) / 255, static_cast<float>(rgb >> 8 & 255) / 255,
          static_cast<float>(rgb & 255) / 255};
}

Rgb to_linear(const Rgb& display) {
  Rgb out;
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = display[i] <= 0.04045f ? display[i] / 12.92f
                                    : std::pow((display[i] + 0.055f) / 1.055f, 2.4f);
  return out;
}

Rgb to_display(const Rgb& linear) {
  Rgb out;
  for (std::size_t i = 0; i < 3; ++i) {
    const float c = std::clamp(linear[i], 0.0f, 1.0f);
    out[i] = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  }
  return out;
}

Rgb ramp_color(ColorMap map, float t) {
  if (map == ColorMap::plain) return hex_color(kClay);
  const std::span<const unsigned> stops = map == ColorMap::damage
                                              ? std::span<const unsigned>(kDamageStops)
                                              : std::span<const unsigned>(kCividisStops);
  const float place = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(stops.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  const float f = place - static_cast<float>(i);
  const Rgb a = to_oklab(to_linear(hex_color(stops[i]))),
            b = to_oklab(to_linear(hex_color(stops[i + 1])));
  return to_display(
      from_oklab({a[0] + (b[0] - a[0]) * f, a[1] + (b[1] - a[1]) * f, a[2] + (b[2] - a[2]) * f}));
}

Rgb piece_color(Index piece) {
  if (piece <= 0) return hex_color(kClay);
  // Steps of the golden angle keep neighbours in number far apart in hue.
  const float hue = static_cast<float>(piece) * 2.39996323f + 0.6f;
  const float lightness = 0.76f + 0.06f * static_cast<float>(piece % 3 - 1);
  const float chroma = 0.085f;
  return to_display(from_oklab({lightness, chroma * std::cos(hue), chroma * std::sin(hue)}));
}

}  // namespace rend
