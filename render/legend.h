// The colour bar in the corner of a picture.
#pragma once

#include "render/renderer.h"

#include <vector>

namespace rend {

/// Two to four round numbers within [low, high], three where possible.
std::vector<float> round_labels(float low, float high);

/// Draws caption, colour bar and round labels on a translucent card into the lower right corner,
/// sized to the picture. Nothing without a caption, for the maps without a scale (plain, pieces)
/// and in pictures too small to read.
void draw_legend(Image& image, const Coloring& coloring, Theme theme);

}  // namespace rend
