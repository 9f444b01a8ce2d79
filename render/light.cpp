// Sets up a frame for the row functions and runs them over rows in parallel.
#include "render/light.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "render/light_kernels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rend {

namespace {

constexpr Index kRows = 16;  // rows a task
constexpr int kTapCount = 12, kPatternRowLength = 20;

void copy(const Vec3f& from, float* to) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}
void copy(const Rgb& from, float* to) { std::copy(from.begin(), from.end(), to); }

/// Offsets of the occlusion taps: a golden-angle spiral whose angle and radius both vary over a 4 x
/// 4 pattern, so that no offset is used twice and silhouettes leave no ghosts.
std::vector<float> make_spiral() {
  std::vector<float> table(4 * kTapCount * 2 * kPatternRowLength);
  for (int row = 0; row < 4; ++row)
    for (int s = 0; s < kTapCount; ++s)
      for (int i = 0; i < kPatternRowLength; ++i) {
        const int cell = row * 4 + (i & 3), turn = (cell * 7) & 15, grow = (cell * 11 + 5) & 15;
        const double angle = s * 2.39996323 + turn * (2 * std::numbers::pi / 16);
        const double radius = std::sqrt((s + (grow + 0.5) / 16) / kTapCount);
        float* const at =
            &table[static_cast<std::size_t>(((row * kTapCount + s) * 2) * kPatternRowLength + i)];
        at[0] = static_cast<float>(std::cos(angle) * radius);
        at[kPatternRowLength] = static_cast<float>(std::sin(angle) * radius);
      }
  return table;
}

/// Thresholds of ordered dither (Bayer 1973) in (0, 1), rows repeated for unaligned vector loads.
std::vector<float> make_dither() {
  std::vector<float> table(8 * 24);
  for (unsigned y = 0; y < 8; ++y)
    for (unsigned x = 0; x < 24; ++x) {
      unsigned rank = 0;
      for (unsigned bit = 0; bit < 3; ++bit)
        rank |= (((x >> bit ^ y >> bit) & 1u) << (2 * (2 - bit) + 1)) |
                ((y >> bit & 1u) << (2 * (2 - bit)));
      table[y * 24 + x] = (static_cast<float>(rank) + 0.5f) / 64;
    }
  return table;
}

MapView map_view(const DepthMap& map) {
  MapView view{map.depth.data(), map.size, {}};
  const LightBox& box = map.box;
  const float texels = 0.5f * static_cast<float>(map.size);
  const auto row = [&](int i, const Vec3f& axis, float scale) {
    for (int k = 0; k < 3; ++k) view.to_map[i][k] = axis[k] * scale;
    view.to_map[i][3] = scale == 0 ? 0 : -axis.dot(box.center) * scale + (i < 2 ? texels : 0.5f);
  };
  row(0, box.u, texels / box.half);
  row(1, box.v, texels / box.half);
  row(2, -box.direction, 0.5f / box.depth);
  return view;
}

/// Nearest depth of every tile and its eight neighbours.
std::vector<float> nearest_tiles(const DepthMap& map) {
  const int tiles = map.size / kTile;
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * tiles + x); };
  std::vector<float> own(static_cast<std::size_t>(tiles * tiles), 1.0f), wide = own;
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
  return wide;
}

/// Halves a square plane with the weights 1 5 10 10 5 1 in both directions: smooth enough that
/// bilinear samples of a small plane show no grid. Columns next to the border, where nothing is
/// drawn, become 0.
void halve(const float* from, int size, float* to, std::vector<float>& scratch) {
  const int half = size / 2;
  scratch.assign(static_cast<std::size_t>(size) * static_cast<std::size_t>(half), 0.0f);
  for (int y = 0; y < size; ++y) {
    const float* const p = from + static_cast<std::size_t>(y) * static_cast<std::size_t>(size);
    float* const q = scratch.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(half);
    for (int x = 1; x + 1 < half; ++x)
      q[x] = (1 / 32.0f) * (p[2 * x - 2] + p[2 * x + 3] + 5 * (p[2 * x - 1] + p[2 * x + 2]) +
                            10 * (p[2 * x] + p[2 * x + 1]));
  }
  const auto line = [&](int y) {
    return scratch.data() +
           static_cast<std::size_t>(std::clamp(y, 0, size - 1)) * static_cast<std::size_t>(half);
  };
  for (int y = 0; y < half; ++y) {
    const float *a = line(2 * y - 2), *b = line(2 * y - 1), *c = line(2 * y), *d = line(2 * y + 1);
    const float *e = line(2 * y + 2), *f = line(2 * y + 3);
    float* const q = to + static_cast<std::size_t>(y) * static_cast<std::size_t>(half);
    for (int x = 0; x < half; ++x)
      q[x] = (1 / 32.0f) * (a[x] + f[x] + 5 * (b[x] + e[x]) + 10 * (c[x] + d[x]));
  }
}

/// Blurred silhouettes for shadows on the floor.
struct Silhouettes {
  std::vector<float> mask, blocker;
  ShadowLevels levels{};

  explicit Silhouettes(const DepthMap& map) {
    std::size_t cells = 0;
    for (int k = 0, size = map.size; k < ShadowLevels::kCount; ++k, size /= 2) {
      levels.scale[k] = 1.0f / static_cast<float>(1 << k);
      levels.offset[k] = static_cast<std::int32_t>(cells);
      levels.size[k] = size;
      cells += static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    }
    mask.resize(cells);
    blocker.resize(cells);
    const std::size_t base =
        static_cast<std::size_t>(map.size) * static_cast<std::size_t>(map.size);
    for (std::size_t i = 0; i < base; ++i) {
      const float casts = map.depth[i] < 1 ? 1.0f : 0.0f;
      mask[i] = casts;
      blocker[i] = casts * map.depth[i];
    }
    std::vector<float> scratch;
    for (int k = 1; k < ShadowLevels::kCount; ++k)
      for (std::vector<float>* plane : {&mask, &blocker})
        halve(plane->data() + levels.offset[k - 1], levels.size[k - 1],
              plane->data() + levels.offset[k], scratch);
    levels.mask = mask.data();
    levels.blocker = blocker.data();
  }
};

/// The planes and tables a frame points to.
struct FrameStore {
  LightFrame frame{};
  std::vector<float> nearest, spiral = make_spiral(), dither = make_dither(), albedo;
  std::vector<float> half_depth, occlusion_raw, occlusion;
  std::vector<std::uint32_t> packed, smooth;

  /// What finish() needs: sizes, theme, output planes.
  void set_output(int width, int height, int stride, const Look& look) {
    LightFrame& f = frame;
    f.width = width, f.height = height, f.stride = stride;
    f.exposure = look.exposure;
    copy(look.backdrop_center, f.backdrop_center);
    copy(look.backdrop_edge, f.backdrop_edge);
    copy(look.floor_ambient, f.floor_ambient);
    f.dither = dither.data();
    const std::size_t cells =
        static_cast<std::size_t>(stride) * static_cast<std::size_t>(height) + 2 * kLanePad;
    packed.resize(cells);
    smooth.resize(cells);
    f.packed = packed.data() + kLanePad;
    f.smooth = smooth.data() + kLanePad;
  }

  void set_scene(const GBuffer& picture, const View& view, const DepthMap& key,
                 const Silhouettes& shadow, const GroundMap& ground, const Look& look) {
    LightFrame& f = frame;
    f.depth = picture.depth.data();
    f.surface = picture.surface.data();
    copy(view.eye, f.eye);
    copy(view.right, f.right);
    copy(view.up, f.up);
    copy(view.forward, f.forward);
    f.u_scale = 2 * view.tan_x / static_cast<float>(view.width);
    f.v_scale = -2 * view.tan_y / static_cast<float>(view.height);
    f.u_shift = -view.tan_x - view.shift_x * f.u_scale;
    f.v_shift = view.tan_y - view.shift_y * f.v_scale;
    f.near = view.near;
    f.far = view.far;

    f.key = map_view(key);
    nearest = nearest_tiles(key);
    f.nearest = nearest.data();
    f.tiles = key.size / kTile;
    f.levels = shadow.levels;
    f.ground = ground.open.data();
    f.ground_size = GroundMap::kSize;
    f.ground_scale = GroundMap::kSize / (2 * ground.half);
    f.ground_shift[0] = (ground.half - ground.center_x) * f.ground_scale;
    f.ground_shift[1] = (ground.half - ground.center_z) * f.ground_scale;
    // A point light seen from `d` behind a caster leaves a half shadow d * tan(radius) wide on each
    // side.
    f.penumbra = 2 * key.box.depth * 2 * std::tan(look.key_radius) * 0.5f *
                 static_cast<float>(key.size) / key.box.half;

    copy(look.key_direction, f.key_direction);
    copy(look.rim_direction, f.rim_direction);
    copy(look.sky_direction, f.sky_direction);
    copy(look.key, f.key_color);
    copy(look.rim, f.rim);
    copy(look.sky, f.sky_color);
    copy(look.bounce, f.bounce);
    copy(look.fill, f.fill);
    // From below the floor there is none.
    f.has_floor = look.has_floor && view.eye.y() > look.floor;
    f.floor = look.floor;
    copy(look.floor_center, f.floor_center);
    f.inverse_fade2 = 1 / (look.floor_fade * look.floor_fade);
    f.occlusion_radius = look.occlusion_radius;
    f.normal_offset = look.normal_offset;
    f.depth_bias = look.depth_bias;
    std::copy(look.gloss.begin(), look.gloss.end(), f.gloss);
    std::copy(look.fresnel.begin(), look.fresnel.end(), f.fresnel);
    albedo.resize(3 * 1024);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < 1024; ++i) albedo[c * 1024 + i] = look.albedo[i][c];
    f.albedo = albedo.data();
    f.spiral = spiral.data();
  }

  void set_half_planes() {
    LightFrame& f = frame;
    f.half_width = (f.width + 1) / 2;
    f.half_height = (f.height + 1) / 2;
    f.half_stride = padded(f.half_width) + 2 * kLanePad;
    const std::size_t cells =
        static_cast<std::size_t>(f.half_stride) * static_cast<std::size_t>(f.half_height) +
        2 * kLanePad;
    for (auto [plane, pointer] : {std::pair{&half_depth, &f.half_depth},
                                  {&occlusion_raw, &f.occlusion_raw},
                                  {&occlusion, &f.occlusion}}) {
      plane->resize(cells);
      *pointer = plane->data();
    }
  }

  void run(void (*rows)(const LightFrame&, int, int), int count) const {
    parallel_chunks(count, kRows, [&](Index begin, Index end) { rows(frame, begin, end); });
  }

  Image image(const std::uint32_t* words) const {
    Image out;
    out.width = frame.width;
    out.height = frame.height;
    out.rgb.resize(3 * static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    parallel_for(out.height, kRows, [&](Index y) {
      const std::uint32_t* const from = words + static_cast<std::ptrdiff_t>(y) * frame.stride;
      std::uint8_t* const to = out.rgb.data() + 3 * static_cast<std::ptrdiff_t>(y) * out.width;
      for (int x = 0; x < out.width; ++x) {
        to[3 * x] = static_cast<std::uint8_t>(from[x]);
        to[3 * x + 1] = static_cast<std::uint8_t>(from[x] >> 8);
        to[3 * x + 2] = static_cast<std::uint8_t>(from[x] >> 16);
      }
    });
    return out;
  }
};

Image light_with(const LightKernels& kernels, const GBuffer& picture, const View& view,
                 const DepthMap& key, const GroundMap& ground, const Look& look) {
  const Silhouettes shadow(key);
  FrameStore store;
  store.set_output(picture.width, picture.height, picture.stride, look);
  store.set_scene(picture, view, key, shadow, ground, look);
  store.set_half_planes();
  const LightFrame& f = store.frame;
  store.run(kernels.half_depth, f.half_height);
  store.run(kernels.occlusion, f.half_height);
  store.run(kernels.blur, f.half_height);
  store.run(kernels.shade, f.height);
  store.run(kernels.smooth_edges, f.height);
  return store.image(f.smooth);
}

}  // namespace

std::string light_lanes() { return lane_light_target(); }

Image light(const GBuffer& picture, const View& view, const DepthMap& key, const GroundMap& ground,
            const Look& look) {
  return light_with(lane_light_kernels(), picture, view, key, ground, look);
}

Image light_reference(const GBuffer& picture, const View& view, const DepthMap& key,
                      const GroundMap& ground, const Look& look) {
  return light_with(reference_light_kernels(), picture, view, key, ground, look);
}

void LightSum::add(const GBuffer& picture, const View& view, const DepthMap& key,
                   const GroundMap& ground, const DepthMap& sky, const Look& look) {
  if (passes_ == 0) {
    width_ = picture.width, height_ = picture.height, stride_ = picture.stride;
    planes_.assign(
        6 * static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height_) + kLanePad, 0.0f);
  }
  const Silhouettes shadow(key);
  const MapView sky_view = map_view(sky);
  FrameStore store;
  store.set_output(width_, height_, stride_, look);
  store.set_scene(picture, view, key, shadow, ground, look);
  store.frame.sky = &sky_view;
  store.frame.planes = planes_.data();
  store.run(lane_light_kernels().accumulate, height_);
  ++passes_;
}

Image LightSum::image(const Look& look) const {
  if (passes_ == 0) throw Error("still", "no pass was added");
  FrameStore store;
  store.set_output(width_, height_, stride_, look);
  // resolve_rows only reads the sums.
  store.frame.planes = const_cast<float*>(planes_.data());
  store.frame.passes = static_cast<float>(passes_);
  store.run(lane_light_kernels().resolve, height_);
  return store.image(store.frame.packed);
}

}  // namespace rend
