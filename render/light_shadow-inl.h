// Shadows of the key light, on the mesh and on the floor; no include guard, see light_kernels-inl.h.

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
