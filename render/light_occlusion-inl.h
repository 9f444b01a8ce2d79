// Ambient occlusion at half size; no include guard, see light_kernels-inl.h.

/// View depth of every second pixel, the floor included.
REND_LANES void half_depth_rows(const LightFrame& f, int begin, int end) {
  for (int y = begin; y < end; ++y) {
    float* const out = f.half_depth + y * f.half_stride + kLanePad;
    const float* const in = f.depth + 2 * y * f.stride;
    const float v = ray_v(f, 2 * y);
    for (int x = 0; x < f.half_width; x += lane_count()) {
      const F window = load_even(in + 2 * x);
      const F u = ray_u(f, ramp(static_cast<float>(x)) * 2.0f);
      const F dy = u * f.right[1] + (f.forward[1] + f.up[1] * v);
      store(select(window < num(1), linear_depth(f, window), floor_depth(f, dy)), out + x);
    }
    for (int k = 1; k <= kLanePad; ++k) {
      out[-k] = out[0];
      out[f.half_width - 1 + k] = out[f.half_width - 1];
    }
  }
}

/// Ambient occlusion at half size: taps on a spiral that turns from pixel to pixel in a 4 x 4
/// pattern.
REND_LANES void occlusion_rows(const LightFrame& f, int begin, int end) {
  const float radius = f.occlusion_radius;
  const float pixels = radius / (-2 * f.v_scale);  // half pixels covered by the radius at depth 1
  const float inverse_reach = 1 / (1.6f * radius * radius);
  for (int y = begin; y < end; ++y) {
    const float* const depth = f.half_depth + kLanePad;
    const float* const row = depth + y * f.half_stride;
    float* const out = f.occlusion_raw + y * f.half_stride + kLanePad;
    const float v = ray_v(f, 2 * y);
    const float* const pattern = f.spiral + (y & 3) * kTaps * 2 * kPatternRow;
    for (int x = 0; x < f.half_width; x += lane_count()) {
      const F z = load(row + x);
      const M mesh = load_even(f.depth + 2 * y * f.stride + 2 * x) < num(1);
      if (!any(mesh)) {
        store(num(1), out + x);
        continue;
      }
      const F column = ramp(static_cast<float>(x));
      const F u = ray_u(f, column * 2.0f);
      const V3 world = decode_normal(load_even(f.surface + 2 * y * f.stride + 2 * x));
      const F nx = dot(world, f.right), ny = dot(world, f.up), nz = dot(world, f.forward);
      const F px = u * z, py = z * v;
      const F reach = minimum(maximum(pixels * inverse(z), num(3)), num(110));
      F occluded = num(0);
      for (int s = 0; s < kTaps; ++s) {
        const float* const offset = pattern + s * 2 * kPatternRow + (x & 3);
        const F tap_x = column + (reach * load(offset) + 0.5f);
        const F tap_y = reach * load(offset + kPatternRow) + (static_cast<float>(y) + 0.5f);
        const I ix = minimum(truncate(maximum(tap_x, num(0))), whole(f.half_width - 1));
        const I iy = minimum(truncate(maximum(tap_y, num(0))), whole(f.half_height - 1));
        const F tz = gather(depth, iy * whole(f.half_stride) + ix);
        const F tv = (real(iy) * 2.0f + 0.5f) * f.v_scale + f.v_shift;
        const F dx = ray_u(f, real(ix) * 2.0f) * tz - px, dy = tv * tz - py, dz = tz - z;
        const F d2 = dx * dx + dy * dy + dz * dz;
        const F slope = (dx * nx + dy * ny + dz * nz) * inverse_root(d2 + 1e-6f * radius * radius);
        occluded =
            occluded + maximum(slope - 0.10f, num(0)) * maximum(1.0f - d2 * inverse_reach, num(0));
      }
      store(select(mesh, clamp01(1.0f - occluded * (2.9f / kTaps)), num(1)), out + x);
    }
    for (int k = 1; k <= kLanePad; ++k) {
      out[-k] = out[0];
      out[f.half_width - 1 + k] = out[f.half_width - 1];
    }
  }
}

/// Mean over the 4 x 4 pattern, of pixels at about the same depth. Weights are all the same on a
/// surface that slants a little, or the pattern would show as faint stripes.
REND_LANES void blur_rows(const LightFrame& f, int begin, int end) {
  for (int y = begin; y < end; ++y) {
    const float* const depth = f.half_depth + kLanePad;
    const float* const raw = f.occlusion_raw + kLanePad;
    float* const out = f.occlusion + y * f.half_stride + kLanePad;
    for (int x = 0; x < f.half_width; x += lane_count()) {
      const F z = load(depth + y * f.half_stride + x);
      const F sharpness = 12.0f * inverse(z);
      F sum = num(0), weights = num(0);
      for (int j = -2; j < 2; ++j) {
        const int yy = y + j < 0 ? 0 : y + j < f.half_height ? y + j : f.half_height - 1;
        for (int i = -2; i < 2; ++i) {
          const int at = yy * f.half_stride + x + i;
          const F near = 1.25f - absolute(load(depth + at) - z) * sharpness;
          const F w = minimum(maximum(near, num(1e-3f)), num(1));
          sum = sum + w * load(raw + at);
          weights = weights + w;
        }
      }
      store(clamp01(sum * inverse(weights)), out + x);
    }
    for (int k = 1; k <= kLanePad; ++k) {
      out[-k] = out[0];
      out[f.half_width - 1 + k] = out[f.half_width - 1];
    }
  }
}

/// Occlusion at full size: bilinear, among half pixels at about the same depth.
REND_LANES F occlusion_at(const LightFrame& f, int x, int y, F z) {
  const I column = truncate(ramp(static_cast<float>(x)));
  const F odd = 0.5f * real(column & whole(1));
  const I index = shift_right<1>(column) + whole((y >> 1) * f.half_stride);
  const F sharpness = 20.0f * inverse(z);
  F sum = num(0), weights = num(0);
  for (int j = 0; j <= (y & 1); ++j) {
    const int down = (y >> 1) + j < f.half_height ? j * f.half_stride : 0;
    const float* const depth = f.half_depth + kLanePad + down;
    const float* const value = f.occlusion + kLanePad + down;
    for (int i = 0; i < 2; ++i) {
      const F w = (i ? odd : 1.0f - odd) *
                  maximum(1.0f - absolute(gather(depth + i, index) - z) * sharpness, num(1e-3f));
      sum = sum + w * gather(value + i, index);
      weights = weights + w;
    }
  }
  return sum * inverse(weights);
}
