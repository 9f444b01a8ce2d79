// Edges without stairs; no include guard, see light_kernels-inl.h.

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
