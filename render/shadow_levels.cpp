// Summaries of a depth map that spare the light most of its texels.
#include "render/shadow_levels.h"

#include <algorithm>

namespace rend {

namespace {

/// Halves a square plane with the weights 1 5 10 10 5 1 in both directions. Columns next to the
/// border, where nothing is drawn, become 0.
void halve(const float* from, int size, float* to, std::vector<float>& scratch) {
  const int half = size / 2;
  scratch.resize(static_cast<std::size_t>(size));
  const auto line = [&](int y) {
    return from + static_cast<std::ptrdiff_t>(std::clamp(y, 0, size - 1)) * size;
  };
  for (int y = 0; y < half; ++y) {
    const float *a = line(2 * y - 2), *b = line(2 * y - 1), *c = line(2 * y), *d = line(2 * y + 1);
    const float *e = line(2 * y + 2), *f = line(2 * y + 3);
    float* const p = scratch.data();
    for (int x = 0; x < size; ++x)
      p[x] = (1 / 32.0f) * (a[x] + f[x] + 5 * (b[x] + e[x]) + 10 * (c[x] + d[x]));
    float* const q = to + static_cast<std::ptrdiff_t>(y) * half;
    q[0] = q[half - 1] = 0;
    for (int x = 1; x + 1 < half; ++x)
      q[x] = (1 / 32.0f) * (p[2 * x - 2] + p[2 * x + 3] + 5 * (p[2 * x - 1] + p[2 * x + 2]) +
                            10 * (p[2 * x] + p[2 * x + 1]));
  }
}

}  // namespace

void nearest_tiles(const DepthMap& map, std::vector<float>& wide) {
  const int tiles = map.size / kTile;
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * tiles + x); };
  std::vector<float> own(static_cast<std::size_t>(tiles * tiles), 1.0f);
  wide = own;
  for (int y = 0; y < map.size; ++y)
    for (int tx = 0; tx < tiles; ++tx) {
      const float* p = map.depth.data() +
                       static_cast<std::size_t>(y) * static_cast<std::size_t>(map.size) +
                       static_cast<std::size_t>(tx * kTile);
      float m[4] = {p[0], p[1], p[2], p[3]};
      for (int k = 4; k < kTile; k += 4)
        for (int l = 0; l < 4; ++l) m[l] = p[k + l] < m[l] ? p[k + l] : m[l];
      float& low = own[at(tx, y / kTile)];
      low = std::min({low, m[0], m[1], m[2], m[3]});
    }
  for (int y = 0; y < tiles; ++y)
    for (int x = 0; x < tiles; ++x)
      for (int j = std::max(0, y - 1); j <= std::min(tiles - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(tiles - 1, x + 1); ++i)
          wide[at(x, y)] = std::min(wide[at(x, y)], own[at(i, j)]);
}

void Silhouettes::build(const DepthMap& map) {
  std::size_t cells = 0;
  for (int k = 0, size = map.size; k < ShadowLevels::kCount; ++k, size /= 2) {
    levels.scale[k] = 1.0f / static_cast<float>(1 << k);
    levels.offset[k] = static_cast<std::int32_t>(cells);
    levels.size[k] = size;
    cells += static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  }
  mask.resize(cells);
  blocker.resize(cells);
  const std::size_t base = static_cast<std::size_t>(map.size) * static_cast<std::size_t>(map.size);
  for (std::size_t i = 0; i < base; ++i) {
    const float casts = map.depth[i] < 1 ? 1.0f : 0.0f;
    mask[i] = casts;
    blocker[i] = casts * map.depth[i];
  }
  for (int k = 1; k < ShadowLevels::kCount; ++k)
    for (std::vector<float>* plane : {&mask, &blocker})
      halve(plane->data() + levels.offset[k - 1], levels.size[k - 1],
            plane->data() + levels.offset[k], scratch);
  const int last = ShadowLevels::kCount - 1, side = levels.size[last];
  near.assign(static_cast<std::size_t>(side * side), 0.0f);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (int j = std::max(0, y - 1); j <= std::min(side - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(side - 1, x + 1); ++i)
          near[static_cast<std::size_t>(y * side + x)] +=
              mask[static_cast<std::size_t>(levels.offset[last] + j * side + i)];
  levels.near = near.data();
  levels.mask = mask.data();
  levels.blocker = blocker.data();
}

}  // namespace rend
