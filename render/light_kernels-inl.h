// Row functions of the light over a lane vocabulary (F, I, M and their operations); included inside
// the namespace that defines the vocabulary and REND_LANES, once per instruction set and once in
// double precision. No include guard, no includes: both belong to the including file.

constexpr int kTaps = 12, kPatternRow = 20;

struct V3 {
  F x, y, z;
};

/// What reaches the eye through one pixel: light of the mesh, share it covers, light on the floor
/// relative to an open floor (ambient and key).
struct Lit {
  F color[3], cover, ambient, key;
};

REND_LANES F dot(const V3& a, const V3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
REND_LANES F dot(const V3& a, const float* b) { return a.x * b[0] + a.y * b[1] + a.z * b[2]; }
REND_LANES V3 scaled(const V3& a, F s) { return {a.x * s, a.y * s, a.z * s}; }
REND_LANES F clamp01(F a) { return minimum(maximum(a, num(0)), num(1)); }
REND_LANES F smoothstep01(F t) { return t * t * (3.0f - 2.0f * t); }

REND_LANES F ray_u(const LightFrame& f, F x) { return (x + 0.5f) * f.u_scale + f.u_shift; }
REND_LANES float ray_v(const LightFrame& f, int y) {
  return (static_cast<float>(y) + 0.5f) * f.v_scale + f.v_shift;
}

REND_LANES F linear_depth(const LightFrame& f, F window) {
  return (f.near * f.far) * inverse(f.far - minimum(window, num(1)) * (f.far - f.near));
}

REND_LANES F farthest(const LightFrame& f) { return num(100 * f.far); }

/// View depth of the floor along a ray with vertical component dy; farthest() where it is missed.
REND_LANES F floor_depth(const LightFrame& f, F dy) {
  if (!f.has_floor) return farthest(f);
  const F down = minimum(dy, num(-1e-5f));
  const F z = (f.floor - f.eye[1]) * inverse(down);
  return select(both(dy < num(-1e-5f), z < farthest(f)), z, farthest(f));
}

/// Unit normal of a surface word (octahedral map).
REND_LANES V3 decode_normal(I word) {
  const F ox = (real(word & whole(2047)) - 1023.5f) * (1 / 1023.5f);
  const F oy = (real(shift_right<11>(word) & whole(2047)) - 1023.5f) * (1 / 1023.5f);
  const F z = 1.0f - absolute(ox) - absolute(oy);
  const F fold = maximum(num(0) - z, num(0));
  const V3 n = {ox - with_sign(fold, ox), oy - with_sign(fold, oy), z};
  return scaled(n, inverse_root(dot(n, n) + 1e-12f));
}

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

/// Mean over the 4 x 4 pattern, of pixels at about the same depth.
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
          const F w = maximum(1.0f - absolute(load(depth + at) - z) * sharpness, num(1e-3f));
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

/// Entry `kind` of a table of four.
REND_LANES F by_kind(const float* table, I kind) {
  const F k = real(kind);
  const F low = select(k < num(0.5f), num(table[0]), num(table[1]));
  const F high = select(k < num(2.5f), num(table[2]), num(table[3]));
  return select(k < num(1.5f), low, high);
}

REND_LANES V3 to_map(const MapView& map, const V3& p) {
  return {dot(p, map.to_map[0]) + map.to_map[0][3], dot(p, map.to_map[1]) + map.to_map[1][3],
          dot(p, map.to_map[2]) + map.to_map[2][3]};
}

/// Share of the light that passes a depth map, over 3 x 3 texels with bilinear weights. `asked`:
/// lanes that need it.
REND_LANES F map_visibility(const MapView& map, const V3& at, M asked, const float* nearest,
                            int tiles) {
  // Nothing was drawn beyond the map's depth range: what lies there is judged by silhouettes alone.
  const F depth = minimum(at.z, num(1));
  const float limit = static_cast<float>(map.size - 5);
  const F tu = minimum(maximum(at.x - 0.5f, num(2)), num(limit));
  const F tv = minimum(maximum(at.y - 0.5f, num(2)), num(limit));
  const I iu = truncate(tu), iv = truncate(tv);
  if (nearest) {
    // Nothing near enough in this tile or its neighbours: lit, without looking at texels.
    const F first = gather(nearest, shift_right<4>(iv) * whole(tiles) + shift_right<4>(iu));
    asked = both(asked, first < depth);
  }
  if (!any(asked)) return num(1);
  const F fu = tu - real(iu), fv = tv - real(iv);
  const F column[4] = {1.0f - fu, num(1), num(1), fu}, line[4] = {1.0f - fv, num(1), num(1), fv};
  const I corner = (iv - whole(1)) * whole(map.size) + iu - whole(1);
  F lit = num(0);
  for (int j = 0; j < 4; ++j) {
    F sum = num(0);
    for (int i = 0; i < 4; ++i)
      sum = sum + select(gather(map.depth + j * map.size + i, corner) < depth, num(0), column[i]);
    lit = lit + sum * line[j];
  }
  return lit * (1 / 9.0f);
}

/// Where a plane of the shadow levels is sampled and how its 3 x 3 texels weigh (quadratic
/// B-spline: bilinear samples of coarse levels show their grid).
struct Sample {
  I at, size;
  F column[3], line[3];
};

REND_LANES void spline_weights(F t, F* weights) {
  const F before = 0.5f - t, after = 0.5f + t;
  weights[0] = 0.5f * before * before;
  weights[1] = 0.75f - t * t;
  weights[2] = 0.5f * after * after;
}

/// (u, v) in texels of level 0; `offset`, `size` of the level.
REND_LANES Sample place_sample(F u, F v, F scale, I offset, I size) {
  const F top = real(size) - 1.001f;
  const F tu = minimum(maximum(u * scale, num(1)), top),
          tv = minimum(maximum(v * scale, num(1)), top);
  const I iu = truncate(tu), iv = truncate(tv);
  Sample sample;
  sample.at = offset + (iv - whole(1)) * size + iu - whole(1);
  sample.size = size;
  spline_weights(tu - real(iu) - 0.5f, sample.column);
  spline_weights(tv - real(iv) - 0.5f, sample.line);
  return sample;
}

REND_LANES F take_sample(const float* plane, const Sample& s) {
  F sum = num(0);
  I at = s.at;
  for (int j = 0; j < 3; ++j, at = at + s.size)
    sum = sum + s.line[j] * (s.column[0] * gather(plane, at) + s.column[1] * gather(plane + 1, at) +
                             s.column[2] * gather(plane + 2, at));
  return sum;
}

/// Key light on the floor, one element for 2 x 2 texels of the key's map: a shadow as sharp at the
/// contact and as soft away from it as an area light makes it. The floor is a plane of the map, so
/// its depth is linear in the texel.
REND_LANES void floor_shadow_rows(const LightFrame& f, int begin, int end) {
  const ShadowLevels& levels = f.levels;
  constexpr int kSearch = ShadowLevels::kCount - 1;
  const int side = f.key.size / 2;
  for (int y = begin; y < end; ++y) {
    const float v = 2 * static_cast<float>(y) + 1;
    const float* const near = levels.near + (2 * y >> kSearch) * levels.size[kSearch];
    for (int x = 0; x < side; x += lane_count()) {
      float* const out = f.floor_shadow + y * side + x;
      const F u = 2.0f * ramp(static_cast<float>(x)) + 1.0f;
      if (!any(num(0) < gather(near, truncate(u * levels.scale[kSearch])))) {
        store(num(1), out);
        continue;
      }
      const Sample around =
          place_sample(u, num(v), num(levels.scale[kSearch]), whole(levels.offset[kSearch]),
                       whole(levels.size[kSearch]));
      const F wide = take_sample(levels.mask, around);
      const F blocker = take_sample(levels.blocker, around) * inverse(maximum(wide, num(1e-4f)));
      const F depth = u * f.floor_depth[0] + (f.floor_depth[1] * v + f.floor_depth[2]);
      const F width = maximum(depth - blocker, num(0)) * f.penumbra;
      F level = num(0);
      for (int k = 0; k < kSearch; ++k)
        level = level + clamp01((width - static_cast<float>(1 << k)) * levels.scale[k]);
      const I low = minimum(truncate(level), whole(kSearch - 1)), high = low + whole(1);
      const F a = take_sample(levels.mask,
                              place_sample(u, num(v), gather(levels.scale, low),
                                           gather(levels.offset, low), gather(levels.size, low)));
      const F b = take_sample(levels.mask,
                              place_sample(u, num(v), gather(levels.scale, high),
                                           gather(levels.offset, high), gather(levels.size, high)));
      store(1.0f - (a + (b - a) * (level - real(low))), out);
    }
  }
}

/// Bilinear sample of a square plane whose border is 1, at (u, v) in its elements; 1 outside.
REND_LANES F plane_sample(const float* plane, int size, F u, F v, M asked) {
  const F top = num(static_cast<float>(size) - 1.001f);
  u = minimum(maximum(u - 0.5f, num(0)), top);
  v = minimum(maximum(v - 0.5f, num(0)), top);
  // A place clamped to the border is outside.
  const M inside = both(both(num(0) < u, u < top), both(num(0) < v, v < top));
  if (!any(both(asked, inside))) return num(1);
  const I iu = truncate(u), iv = truncate(v);
  const F fu = u - real(iu), fv = v - real(iv);
  const I at = iv * whole(size) + iu, below = at + whole(size);
  const F a = gather(plane, at), b = gather(plane + 1, at);
  const F c = gather(plane, below), d = gather(plane + 1, below);
  const F upper = a + (b - a) * fu, lower = c + (d - c) * fu;
  return select(inside, upper + (lower - upper) * fv, num(1));
}

REND_LANES Lit light_lanes(const LightFrame& f, int x, int y) {
  Lit lit = {{num(0), num(0), num(0)}, num(0), num(1), num(1)};
  const float v = ray_v(f, y);
  const F u = ray_u(f, ramp(static_cast<float>(x)));
  const V3 ray = {u * f.right[0] + (f.forward[0] + f.up[0] * v),
                  u * f.right[1] + (f.forward[1] + f.up[1] * v),
                  u * f.right[2] + (f.forward[2] + f.up[2] * v)};
  const F window = load(f.depth + y * f.stride + x);
  const M mesh = window < num(1);
  const F floor_z = floor_depth(f, ray.y);
  const M on_floor = both(not_(mesh), floor_z < farthest(f));
  const bool any_mesh = any(mesh), any_floor = any(on_floor);
  if (!any_mesh && !any_floor) return lit;

  const F z = select(mesh, linear_depth(f, window), floor_z);
  const V3 p = {ray.x * z + f.eye[0], ray.y * z + f.eye[1], ray.z * z + f.eye[2]};
  if (any_floor) {
    const F dx = p.x - f.floor_center[0], dz = p.z - f.floor_center[2];
    const F fade = 1.0f - smoothstep01(minimum((dx * dx + dz * dz) * f.inverse_fade2, num(1)));
    const F open = plane_sample(f.ground, f.ground_size, p.x * f.ground_scale + f.ground_shift[0],
                                p.z * f.ground_scale + f.ground_shift[1], on_floor);
    const V3 at = to_map(f.key, p);
    const F shadow =
        plane_sample(f.floor_shadow, f.key.size / 2, at.x * 0.5f, at.y * 0.5f, on_floor);
    const F key = shadow * (0.75f + 0.25f * open);
    lit.ambient = select(on_floor, 1.0f + (open - 1.0f) * fade, num(1));
    lit.key = select(on_floor, 1.0f + (key - 1.0f) * fade, num(1));
  }
  if (!any_mesh) return lit;

  const F open = f.sky ? num(1) : occlusion_at(f, x, y, z);
  const I word = load(f.surface + y * f.stride + x);
  const I kind = shift_right<22>(word) & whole(3), entry = shift_right<22>(word) & whole(1023);
  const V3 n = decode_normal(word);
  const V3 to_eye = scaled(ray, num(0) - inverse_root(dot(ray, ray)));
  const F n_key = maximum(dot(n, f.key_direction), num(0)), n_eye = clamp01(dot(n, to_eye));
  const V3 lifted = {p.x + n.x * f.normal_offset, p.y + n.y * f.normal_offset,
                     p.z + n.z * f.normal_offset};
  V3 at = to_map(f.key, lifted);
  at.z = at.z - f.depth_bias;
  const F visible = map_visibility(f.key, at, both(mesh, num(0) < n_key), f.nearest, f.tiles);
  const F key = n_key * visible * (0.6f + 0.4f * open);

  const V3 h = {to_eye.x + f.key_direction[0], to_eye.y + f.key_direction[1],
                to_eye.z + f.key_direction[2]};
  const F n_h = maximum(dot(n, h) * inverse_root(dot(h, h) + 1e-6f), num(0));
  const F h2 = n_h * n_h, h4 = h2 * h2, h8 = h4 * h4, h16 = h8 * h8;
  const F gloss = by_kind(f.gloss, kind) * h16 * h8 * key;
  const F graze = 1.0f - n_eye, graze2 = graze * graze, graze5 = graze2 * graze2 * graze;
  const F shine = by_kind(f.fresnel, kind), sheen = graze5 * shine;
  const F rim = maximum(dot(n, f.rim_direction), num(0)) * (0.25f + 2.0f * graze5) * open;

  const F upward = 0.5f * n.y + 0.5f;
  F from_sky = upward * open, from_floor = (1.0f - upward) * open;
  if (f.sky) {
    V3 sky_at = to_map(*f.sky, lifted);
    sky_at.z = sky_at.z - 2.0f * f.depth_bias;
    const F n_sky = maximum(dot(n, f.sky_direction), num(0));
    from_sky =
        2.0f * n_sky * map_visibility(*f.sky, sky_at, both(mesh, num(0) < n_sky), nullptr, 0);
    from_floor = (1.0f - upward) * clamp01((p.y - f.floor) * (1.2f / f.occlusion_radius) + 0.15f);
  }
  const F from_eye = n_eye * open;
  for (int c = 0; c < 3; ++c) {
    const F albedo = gather(f.albedo + 1024 * c, entry);
    const F ambient = f.sky_color[c] * from_sky + f.bounce[c] * from_floor + f.fill[c] * from_eye;
    lit.color[c] = select(mesh,
                          albedo * (ambient + f.key_color[c] * key) + f.key_color[c] * gloss +
                              f.rim[c] * rim * (albedo * 0.6f + shine * 0.5f) + ambient * sheen,
                          num(0));
  }
  lit.cover = select(mesh, num(1), num(0));
  return lit;
}

/// Filmic curve of Hejl and Burgess-Dawson: linear light to display values, toe and shoulder in one
/// fraction.
REND_LANES F filmic(F c) {
  c = maximum(c - 0.004f, num(0));
  return c * (6.2f * c + 0.5f) * inverse(c * (6.2f * c + 1.7f) + 0.06f);
}

/// Tone curve, floor and backdrop; 8 bits a channel, dithered so that the backdrop shows no bands.
REND_LANES I finish(const LightFrame& f, const Lit& lit, int x, int y) {
  const F px = (ramp(static_cast<float>(x)) + 0.5f) * (1.0f / static_cast<float>(f.width)) - 0.5f;
  const float py = (static_cast<float>(y) + 0.5f) / static_cast<float>(f.height) - 0.36f;
  const F r2 = px * px * (1 / (0.75f * 0.75f)) + py * py * (1 / (0.8f * 0.8f));
  const F place = minimum(root(r2), num(1));
  const F exposure = f.exposure * (1.0f - 0.18f * minimum(r2, num(1)));
  const F dither = load(f.dither + (y & 7) * 24 + (x & 7));
  const bool any_mesh = any(num(0) < lit.cover);
  I word = whole(0);
  for (int c = 0; c < 3; ++c) {
    const F light = f.floor_ambient[c] * lit.ambient + (1 - f.floor_ambient[c]) * lit.key;
    const F behind = (f.backdrop_center[c] + (f.backdrop_edge[c] - f.backdrop_center[c]) * place) *
                     root(maximum(light, num(0)));
    F display = behind;
    if (any_mesh) display = behind + (filmic(lit.color[c] * exposure) - behind) * lit.cover;
    const I level = truncate(minimum(clamp01(display) * 255.0f + dither, num(255)));
    word = c == 0 ? level : c == 1 ? word | shift_left<8>(level) : word | shift_left<16>(level);
  }
  return word;
}

REND_LANES void shade_rows(const LightFrame& f, int begin, int end) {
  for (int y = begin; y < end; ++y)
    for (int x = 0; x < f.width; x += lane_count())
      store(finish(f, light_lanes(f, x, y), x, y), f.packed + y * f.stride + x);
}

REND_LANES void accumulate_rows(const LightFrame& f, int begin, int end) {
  for (int y = begin; y < end; ++y)
    for (int x = 0; x < f.width; x += lane_count()) {
      const Lit lit = light_lanes(f, x, y);
      const F floor = 1.0f - lit.cover;
      const F terms[6] = {lit.color[0], lit.color[1],        lit.color[2],
                          lit.cover,    lit.ambient * floor, lit.key * floor};
      float* at = f.planes + y * f.stride + x;
      for (int k = 0; k < 6; ++k, at += f.stride * f.height) store(load(at) + terms[k], at);
    }
}

REND_LANES void resolve_rows(const LightFrame& f, int begin, int end) {
  for (int y = begin; y < end; ++y)
    for (int x = 0; x < f.width; x += lane_count()) {
      F sums[6] = {};
      const float* at = f.planes + y * f.stride + x;
      for (int k = 0; k < 6; ++k, at += f.stride * f.height) sums[k] = load(at);
      const F on_mesh = inverse(maximum(sums[3], num(1e-6f)));
      const F on_floor = inverse(maximum(f.passes - sums[3], num(1e-6f)));
      const Lit lit = {{sums[0] * on_mesh, sums[1] * on_mesh, sums[2] * on_mesh},
                       sums[3] * (1 / f.passes),
                       sums[4] * on_floor,
                       sums[5] * on_floor};
      store(finish(f, lit, x, y), f.packed + y * f.stride + x);
    }
}

/// (red + 2 green + blue) / 4: near enough to luma to find edges.
REND_LANES F luma(I word) {
  return real((word & whole(255)) + (shift_right<7>(word) & whole(510)) +
              (shift_right<16>(word) & whole(255))) *
         0.25f;
}

REND_LANES I mix_words(I a, I b, F t) {
  I word = whole(0);
  for (int c = 0; c < 3; ++c) {
    const F from = real(a & whole(255)), to = real(b & whole(255));
    const I level = truncate(from + (to - from) * t + 0.5f);
    word = c == 0 ? level : c == 1 ? word | shift_left<8>(level) : word | shift_left<16>(level);
    a = shift_right<8>(a);
    b = shift_right<8>(b);
  }
  return word;
}

/// Smooths stairs along edges: walks along the edge to both its ends and blends with the pixel
/// across it by the place between them (the idea of FXAA, Lottes 2009).
REND_LANES void smooth_edge_rows(const LightFrame& f, int begin, int end) {
  constexpr int kWalk = 12;
  for (int y = begin; y < end; ++y) {
    const std::uint32_t* const row = f.packed + y * f.stride;
    const int up = y > 0 ? -f.stride : 0, down = y + 1 < f.height ? f.stride : 0;
    for (int x = 0; x < f.width; x += lane_count()) {
      const I word = load(row + x);
      const F m = luma(word), n = luma(load(row + x + up)), s = luma(load(row + x + down));
      const F w = luma(load(row + x - 1)), e = luma(load(row + x + 1));
      const F high = maximum(maximum(maximum(n, s), maximum(w, e)), m);
      const F low = minimum(minimum(minimum(n, s), minimum(w, e)), m);
      const F range = high - low;
      const F column = ramp(static_cast<float>(x));
      const M inside = both(num(0.5f) < column, column < num(static_cast<float>(f.width) - 1.5f));
      const M edge = both(inside, maximum(num(4), high * 0.03f) < range);
      if (!any(edge)) {
        store(word, f.smooth + y * f.stride + x);
        continue;
      }
      const F nw = luma(load(row + x + up - 1)), ne = luma(load(row + x + up + 1));
      const F sw = luma(load(row + x + down - 1)), se = luma(load(row + x + down + 1));
      const F vertical = absolute(nw + 2.0f * n + ne - (sw + 2.0f * s + se));
      const F sideways = absolute(nw + 2.0f * w + sw - (ne + 2.0f * e + se));
      const M lies = not_(vertical < sideways);  // the edge runs along the row

      const F before = select(lies, n, w), after = select(lies, s, e);
      const M first = absolute(after - m) < absolute(before - m);
      const F across = select(first, before, after);
      const I column_index = truncate(column);
      const I step_x = select(lies, whole(1), whole(0)), step_y = select(lies, whole(0), whole(1));
      const I side_x = select(lies, whole(0), select(first, whole(-1), whole(1)));
      const I side_y = select(lies, select(first, whole(-1), whole(1)), whole(0));
      const F middle = 0.5f * (m + across), threshold = 0.25f * absolute(m - across);

      F length[2], last[2];
      for (int side = 0; side < 2; ++side) {
        const int sign = side ? 1 : -1;
        F steps = num(static_cast<float>(kWalk)), at_end = num(0);
        M open = edge;
        for (int k = 1; k <= kWalk && any(open); ++k) {
          const I cx = column_index + step_x * whole(sign * k),
                  cy = whole(y) + step_y * whole(sign * k);
          const I ax = minimum(maximum(cx, whole(0)), whole(f.width - 1));
          const I ay = minimum(maximum(cy, whole(0)), whole(f.height - 1));
          const I bx = minimum(maximum(cx + side_x, whole(0)), whole(f.width - 1));
          const I by = minimum(maximum(cy + side_y, whole(0)), whole(f.height - 1));
          const F here = luma(gather(f.packed, ay * whole(f.stride) + ax));
          const F there = luma(gather(f.packed, by * whole(f.stride) + bx));
          const F off = 0.5f * (here + there) - middle;
          const M ended = both(open, not_(absolute(off) < threshold));
          steps = select(ended, num(static_cast<float>(k)), steps);
          at_end = select(ended, off, at_end);
          open = both(open, not_(ended));
        }
        length[side] = steps;
        last[side] = at_end;
      }
      const M near_first = length[0] < length[1];
      const F shortest = minimum(length[0], length[1]);
      const F end_off = select(near_first, last[0], last[1]);
      // Only the side of a stair that sticks out is moved.
      const M outward = end_off * (m - middle) < num(0);
      const F stair = select(outward, 0.5f - shortest * inverse(length[0] + length[1]), num(0));
      const F mean = (2.0f * (n + s + e + w) + nw + ne + sw + se) * (1 / 12.0f);
      F spike = clamp01(absolute(mean - m) * inverse(maximum(range, num(1))));
      spike = smoothstep01(spike);
      const F blend =
          select(edge, minimum(maximum(stair, spike * spike * 0.6f), num(0.5f)), num(0));
      const I ox = minimum(maximum(column_index + side_x, whole(0)), whole(f.width - 1));
      const I oy = minimum(maximum(whole(y) + side_y, whole(0)), whole(f.height - 1));
      store(mix_words(word, gather(f.packed, oy * whole(f.stride) + ox), blend),
            f.smooth + y * f.stride + x);
    }
  }
}

REND_LANES LightKernels kernel_table() {
  return {floor_shadow_rows, half_depth_rows, occlusion_rows, blur_rows,
          shade_rows,        accumulate_rows, resolve_rows,   smooth_edge_rows};
}
