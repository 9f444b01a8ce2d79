// The colour bar in the corner of a picture.
#include "render/legend.h"
namespace rend {
void draw_legend(Image&, const Coloring&, Theme) {}
}  // namespace rend
