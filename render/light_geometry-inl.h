// Vectors, rays and depths of the light; no include guard, see light_kernels-inl.h.

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
