// Ambient light on the floor.
#include "render/ground_map.h"

#include "engine/core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rend {

namespace {

constexpr int kSize = GroundMap::kSize;
constexpr int kLayers = 3;
constexpr float kLayerHeight[kLayers] = {0.03f, 0.12f,
                                         0.45f};  // in units of the radius of what is drawn
constexpr float kStrength[kLayers] = {0.85f, 0.75f, 0.70f};
constexpr int kMaxSplit = 256;

class HeightGrid {
 public:
  HeightGrid(const GroundMap& map, float floor)
      : cell_(2 * map.half / kSize),
        left_(map.center_x - map.half),
        top_(map.center_z - map.half),
        floor_(floor),
        low(kSize * kSize, std::numeric_limits<float>::infinity()) {}

  float cell() const { return cell_; }

  void add(float x, float y, float z) {
    const float u = (x - left_) / cell_, v = (z - top_) / cell_;
    if (!(u >= 0 && u < kSize && v >= 0 && v < kSize) || y < floor_ - cell_) return;
    float& height =
        low[static_cast<std::size_t>(static_cast<int>(v) * kSize + static_cast<int>(u))];
    height = std::min(height, std::max(y - floor_, 0.0f));
  }

  /// Fills the cells under a triangle that is larger than a cell; its corners are added elsewhere.
  void add_inside(const float* a, const float* b, const float* c) {
    const float width = std::max({a[0], b[0], c[0]}) - std::min({a[0], b[0], c[0]});
    const float depth = std::max({a[2], b[2], c[2]}) - std::min({a[2], b[2], c[2]});
    const float cells = std::max(width, depth) / cell_;
    if (!(cells > 1)) return;
    const int n = std::min(kMaxSplit, static_cast<int>(1.5f * std::min(cells, 1e4f)) + 1);
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const float s = static_cast<float>(i) / static_cast<float>(n),
                    t = static_cast<float>(j) / static_cast<float>(n);
        const float r = 1 - s - t;
        add(r * a[0] + s * b[0] + t * c[0], r * a[1] + s * b[1] + t * c[1],
            r * a[2] + s * b[2] + t * c[2]);
      }
  }

 private:
  float cell_, left_, top_, floor_;

 public:
  std::vector<float> low;
};

/// Running mean over 2 radius + 1 rows, zero outside; all columns of a row at once.
void blur_columns(std::vector<float>& plane, std::vector<float>& scratch, int radius) {
  const float weight = 1.0f / static_cast<float>(2 * radius + 1);
  std::array<float, kSize> sum{};
  const auto row = [&](int y) { return plane.data() + y * kSize; };
  for (int y = 0; y < std::min(radius, kSize); ++y)
    for (int x = 0; x < kSize; ++x) sum[static_cast<std::size_t>(x)] += row(y)[x];
  for (int y = 0; y < kSize; ++y) {
    const float* const enters = y + radius < kSize ? row(y + radius) : nullptr;
    const float* const leaves = y - radius >= 0 ? row(y - radius) : nullptr;
    float* const to = scratch.data() + y * kSize;
    if (enters)
      for (int x = 0; x < kSize; ++x) sum[static_cast<std::size_t>(x)] += enters[x];
    for (int x = 0; x < kSize; ++x) to[x] = sum[static_cast<std::size_t>(x)] * weight;
    if (leaves)
      for (int x = 0; x < kSize; ++x) sum[static_cast<std::size_t>(x)] -= leaves[x];
  }
  plane.swap(scratch);
}

void transpose(std::vector<float>& plane, std::vector<float>& scratch) {
  constexpr int kBlock = 16;
  for (int by = 0; by < kSize; by += kBlock)
    for (int bx = 0; bx < kSize; bx += kBlock)
      for (int y = by; y < by + kBlock; ++y)
        for (int x = bx; x < bx + kBlock; ++x)
          scratch[static_cast<std::size_t>(x * kSize + y)] =
              plane[static_cast<std::size_t>(y * kSize + x)];
  plane.swap(scratch);
}

}  // namespace

GroundMap make_ground_map(const CornerMesh& mesh, const std::vector<PointVertex>& points,
                          float point_radius, float floor, const Bounds3f& bounds) {
  GroundMap map;
  if (bounds.empty()) return map;
  const float radius = bounds.radius();
  const Vec3f size = bounds.box.sizes();
  map.center_x = bounds.center().x();
  map.center_z = bounds.center().z();
  map.half = 0.5f * std::max(size.x(), size.z()) + 0.95f * radius;

  HeightGrid grid(map, floor);
  for (const MeshVertex& v : mesh.vertices) grid.add(v.x[0], v.x[1], v.x[2]);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    grid.add_inside(mesh.vertices[mesh.indices[i]].x, mesh.vertices[mesh.indices[i + 1]].x,
                    mesh.vertices[mesh.indices[i + 2]].x);
  for (const PointVertex& p : points) grid.add(p.x[0], p.x[1] - point_radius, p.x[2]);

  std::vector<float> layer[kLayers];
  parallel_for(kLayers, 1, [&](Index k) {
    std::vector<float>& plane = layer[k];
    plane.assign(kSize * kSize, 0.0f);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      if (!(grid.low[i] < 1e30f)) continue;
      // Each height lies between two layers and is shared by them, evenly in its logarithm.
      const float place = std::log(std::max(grid.low[i] / radius, 1e-4f) / kLayerHeight[0]) /
                          std::log(kLayerHeight[1] / kLayerHeight[0]);
      const float beyond = std::max(place - static_cast<float>(kLayers - 1), 0.0f);
      plane[i] =
          std::max(0.0f, 1 - std::abs(std::clamp(place, 0.0f, static_cast<float>(kLayers - 1)) -
                                      static_cast<float>(k))) *
          std::exp(-1.2f * beyond);
    }
    std::vector<float> scratch(plane.size());
    const int reach = std::clamp(
        static_cast<int>(std::lround(0.62f * kLayerHeight[k] * radius / grid.cell())), 1, 60);
    for (int direction = 0; direction < 2; ++direction) {
      for (int pass = 0; pass < 3; ++pass) blur_columns(plane, scratch, reach);
      transpose(plane, scratch);
    }
  });
  for (std::size_t i = 0; i < map.open.size(); ++i) {
    float open = 1;
    for (int k = 0; k < kLayers; ++k) open *= 1 - kStrength[k] * std::min(layer[k][i], 1.0f);
    map.open[i] = open;
  }
  return map;
}

}  // namespace rend
