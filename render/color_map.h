// Colours of fields: ramps, fragment colours and the spaces they are mixed in.
#pragma once

#include "render/look.h"

#include <vector>

namespace rend {

/// 0xrrggbb as display values in [0, 1].
Rgb hex_color(unsigned rgb);

/// Display value to linear light and back, by the sRGB curve (IEC 61966-2-1).
Rgb to_linear(const Rgb& display);
Rgb to_display(const Rgb& linear);

/// Display colour of a field value t in [0, 1]; stops are mixed in Oklab (Ottosson 2020), so steps
/// look even.
Rgb ramp_color(ColorMap map, float t);

/// Display colour of a fragment: the body's clay for 0, well separated muted tones for the others.
Rgb piece_color(Index piece);

constexpr unsigned kClay = 0xe4ded2, kCrack = 0xcd603c, kGrip = 0x6c747e;

}  // namespace rend
