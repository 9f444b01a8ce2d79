// Row functions of the light over a lane vocabulary (F, I, M and their operations); included inside
// the namespace that defines the vocabulary and REND_LANES, once per instruction set and once in
// double precision. No include guards in these files: the including file decides.

#include "render/light_geometry-inl.h"
#include "render/light_occlusion-inl.h"
#include "render/light_shadow-inl.h"
#include "render/light_shading-inl.h"
#include "render/light_edges-inl.h"

REND_LANES LightKernels kernel_table() {
  return {floor_shadow_rows, half_depth_rows, occlusion_rows, blur_rows,
          shade_rows,        accumulate_rows, resolve_rows,   smooth_edge_rows};
}
