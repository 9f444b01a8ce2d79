// What reaches the eye through a pixel, and its eight bits; no include guard, see light_kernels-inl.h.

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
