// Sets up a frame for the row functions and runs them over rows in parallel.
#include "render/light.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "render/light_kernels.h"
#include "render/shadow_levels.h"

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

/// The planes and tables a frame points to.
struct FrameStore {
  LightFrame frame{};
  Silhouettes shadow;
  std::vector<float> nearest, spiral = make_spiral(), dither = make_dither(), albedo;
  std::vector<float> half_depth, occlusion_raw, occlusion, floor_shadow;
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

  void set_scene(const GBuffer& picture, const PerspectiveView& view, const DepthMap& key,
                 const GroundMap& ground, const Look& look) {
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
    nearest_tiles(key, nearest);
    f.nearest = nearest.data();
    f.tiles = key.size / kTile;
    shadow.build(key);
    f.levels = shadow.levels;
    const std::size_t side = static_cast<std::size_t>(key.size / 2);
    floor_shadow.resize(side * side + kLanePad);
    f.floor_shadow = floor_shadow.data();
    set_floor_depth(key.box, key.size, look.floor);
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

  /// Map depth of the floor as a linear function of the texel: follow the light's ray from the
  /// texel to the floor.
  void set_floor_depth(const LightBox& box, int size, float floor) {
    const float texel = 2 * box.half / static_cast<float>(size),
                sink = box.direction.y() * 2 * box.depth;
    frame.floor_depth[0] = texel * box.u.y() / sink;
    frame.floor_depth[1] = texel * box.v.y() / sink;
    frame.floor_depth[2] =
        0.5f + (box.center.y() - floor - box.half * (box.u.y() + box.v.y())) / sink;
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

}  // namespace

struct LightPlanes::State {
  const LightKernels& kernels;
  FrameStore store{};

  /// All that shading reads.
  void prepare(const GBuffer& picture, const PerspectiveView& view, const DepthMap& key,
               const GroundMap& ground, const Look& look, bool occlusion) {
    store.set_output(picture.width, picture.height, picture.stride, look);
    store.set_scene(picture, view, key, ground, look);
    store.run(kernels.floor_shadow, key.size / 2);
    if (!occlusion) return;
    store.set_half_planes();
    for (const auto rows : {kernels.half_depth, kernels.occlusion, kernels.blur})
      store.run(rows, store.frame.half_height);
  }
};

LightPlanes::LightPlanes(Arithmetic arithmetic)
    : state_(new State{arithmetic == Arithmetic::lanes ? lane_light_kernels()
                                                       : reference_light_kernels()}) {}
LightPlanes::~LightPlanes() = default;

Image LightPlanes::light(const GBuffer& picture, const PerspectiveView& view, const DepthMap& key,
                         const GroundMap& ground, const Look& look) {
  state_->prepare(picture, view, key, ground, look, true);
  const FrameStore& store = state_->store;
  store.run(state_->kernels.shade, store.frame.height);
  store.run(state_->kernels.smooth_edges, store.frame.height);
  return store.image(store.frame.smooth);
}

void LightPlanes::add_pass(const GBuffer& picture, const PerspectiveView& view, const DepthMap& key,
                           const GroundMap& ground, const DepthMap* sky, const Look& look) {
  const std::size_t plane =
      static_cast<std::size_t>(picture.stride) * static_cast<std::size_t>(picture.height);
  if (passes_ == 0) sums_.assign(6 * plane + kLanePad, 0.0f);
  if (sums_.size() != 6 * plane + kLanePad) throw Error("still", "passes differ in size");
  state_->prepare(picture, view, key, ground, look, sky == nullptr);
  LightFrame& f = state_->store.frame;
  const MapView sky_view = sky ? map_view(*sky) : MapView{};
  f.sky = sky ? &sky_view : nullptr;
  f.planes = sums_.data();
  state_->store.run(state_->kernels.accumulate, f.height);
  f.sky = nullptr;
  ++passes_;
}

Image LightPlanes::finish_still(const Look& look) {
  if (passes_ == 0) throw Error("still", "no pass was added");
  FrameStore& store = state_->store;
  store.set_output(store.frame.width, store.frame.height, store.frame.stride, look);
  store.frame.planes = sums_.data();
  store.frame.passes = static_cast<float>(passes_);
  store.run(state_->kernels.resolve, store.frame.height);
  passes_ = 0;
  return store.image(store.frame.packed);
}

std::string light_lanes() { return lane_light_target(); }

}  // namespace rend
