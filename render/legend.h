// The colour bar in the corner of a picture.
#pragma once

#include "render/renderer.h"

namespace rend {

/// Draws caption, colour bar and three round labels into the lower right corner, sized to the
/// picture. Nothing for the maps without a scale (plain, pieces) beyond the caption.
void draw_legend(Image& image, const Coloring& coloring, Theme theme);

}  // namespace rend
