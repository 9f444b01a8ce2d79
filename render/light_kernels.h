// Row functions of the light, one table per instruction set; plain data in and out.
#pragma once

#include "render/gbuffer.h"

#include <cstdint>

namespace rend {

/// A depth map as the kernels read it: texel = to_map * (x, y, z, 1), third row is the map depth.
struct MapView {
  const float* depth;
  int size;
  float to_map[3][4];
};

/// Blurred silhouettes of the casters for soft shadows on the floor: level k has size >> k texels a
/// side.
struct ShadowLevels {
  static constexpr int kCount = 5;
  const float* mask;     ///< share of a texel's neighbourhood that casts
  const float* blocker;  ///< mask times map depth
  const float* near;     ///< last level: positive where a neighbouring texel has a mask
  float scale[kCount];   ///< 2^-k
  std::int32_t offset[kCount], size[kCount];
};

constexpr int kTile = 16;  ///< texels a side of a tile of the nearest-depth map

/// Everything the row functions need. Full-size planes have `stride` elements a row, half-size ones
/// `half_stride`.
struct LightFrame {
  int width, height, stride, half_width, half_height, half_stride;
  const float* depth;
  const std::uint32_t* surface;
  float eye[3], right[3], up[3], forward[3];
  float u_scale, u_shift, v_scale, v_shift;  ///< ray: u = u_scale (x + 1/2) + u_shift
  float near, far;

  MapView key;
  const float* nearest;  ///< per tile: nearest depth in it and its neighbours
  int tiles;
  ShadowLevels levels;
  float* floor_shadow;   ///< key light on the floor, (key.size / 2) squared
  float floor_depth[3];  ///< map depth of the floor = [0] u + [1] v + [2], in texels
  const float* ground;   ///< openness of the floor, ground_size squared
  int ground_size;
  float ground_scale, ground_shift[2];  ///< texel = ground_scale * (x, z) + ground_shift
  const MapView* sky;                   ///< nullptr: ambient occlusion from the half-size plane

  float key_direction[3], rim_direction[3], sky_direction[3];
  float key_color[3], rim[3], sky_color[3], bounce[3], fill[3];
  float exposure;
  float backdrop_center[3], backdrop_edge[3], floor_ambient[3];
  int has_floor;
  float floor, floor_center[3], inverse_fade2;
  float occlusion_radius, normal_offset, depth_bias,
      penumbra;  ///< penumbra: texels per unit of map depth
  float gloss[4], fresnel[4];
  const float* albedo;  ///< 3 planes of 1024
  const float*
      spiral;  ///< [4 rows][12 taps][2][20]: sample offsets, pattern of 4 repeated along a row
  const float* dither;  ///< [8 rows][24]

  float* half_depth;  ///< with kLanePad elements of border left and right, as the two below
  float* occlusion_raw;
  float* occlusion;
  std::uint32_t* packed;  ///< 0x00bbggrr
  std::uint32_t* smooth;
  float* planes;  ///< sums of a still, see LightPlanes
  float passes;   ///< number of sums in `planes`
};

/// Each handles rows [begin, end) of its plane.
struct LightKernels {
  void (*floor_shadow)(const LightFrame&, int begin, int end);
  void (*half_depth)(const LightFrame&, int begin, int end);
  void (*occlusion)(const LightFrame&, int begin, int end);
  void (*blur)(const LightFrame&, int begin, int end);
  void (*shade)(const LightFrame&, int begin, int end);
  void (*accumulate)(const LightFrame&, int begin, int end);
  void (*resolve)(const LightFrame&, int begin, int end);
  void (*smooth_edges)(const LightFrame&, int begin, int end);
};

const LightKernels& lane_light_kernels();  ///< best instruction set of this processor
const char* lane_light_target();
const LightKernels& reference_light_kernels();  ///< double precision, one pixel at a time

}  // namespace rend
