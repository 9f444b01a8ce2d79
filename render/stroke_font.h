// A small stroke font of our own, drawn with antialiased round pens.
#pragma once

#include "render/look.h"

#include <string_view>

namespace rend {

/// Width of a line of UTF-8 text [pixel] for capitals `height` pixels tall.
float text_width(std::string_view text, float height);

/// Blends a line of text into the picture; (x, y) is the left end of the baseline [pixel], `color`
/// a display colour. Characters without a glyph show as a box.
void draw_text(Image& image, std::string_view text, float x, float y, float height,
               const Rgb& color);

}  // namespace rend
