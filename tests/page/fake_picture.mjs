// Draws a stand-in picture for the mock server: two halves of a bar between grips, cast ray by ray, as PNG.
import { deflateSync } from "node:zlib";

const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const unit = (a) => {
  const length = Math.hypot(...a) || 1;
  return a.map((x) => x / length);
};
const mix = (a, b, t) => a.map((x, i) => x + (b[i] - x) * t);
const clamp01 = (x) => Math.min(1, Math.max(0, x));
const smooth = (a, b, x) => {
  const t = clamp01((x - a) / (b - a));
  return t * t * (3 - 2 * t);
};

const LIGHT = unit([-0.45, 0.9, 0.55]);
const DAMAGE = [
  [228, 222, 210],
  [232, 200, 126],
  [212, 136, 56],
  [143, 53, 24],
];
const CIVIDIS = [
  [0, 32, 77],
  [65, 77, 107],
  [124, 123, 120],
  [188, 175, 111],
  [255, 234, 70],
];
const PIECES = [
  [159, 180, 192],
  [217, 185, 138],
];
const STEEL = [108, 116, 126],
  CRACK = [205, 96, 60];
const BACKDROP = {
  light: [
    [247, 247, 246],
    [213, 216, 219],
  ],
  dark: [
    [46, 51, 57],
    [25, 28, 32],
  ],
};

const ramp = (colors, t) => {
  const x = clamp01(t) * (colors.length - 1),
    i = Math.min(Math.floor(x), colors.length - 2);
  return mix(colors[i], colors[i + 1], x - i);
};

/// Boxes of one frame: {low, high, kind, side}; the body opens at 60 % of the run.
function boxes_of(share, shape) {
  const stretch = 0.16 * smooth(0, 0.7, share),
    gap = 0.11 * smooth(0.6, 1, share);
  const { half = 0.5, height = 0.1, depth = 0.1 } = shape;
  const boxes = [];
  const pieces = 12;
  for (const side of [-1, 1]) {
    for (let k = 0; k < pieces; k++) {
      const a = k / pieces,
        b = (k + 1) / pieces,
        middle = (a + b) / 2;
      const neck = 1 - 0.42 * smooth(0, 0.5, share) * Math.exp(-((middle / 0.22) ** 2));
      const x0 = side * (a * (half + stretch) + gap),
        x1 = side * (b * (half + stretch) + gap);
      boxes.push({
        low: [Math.min(x0, x1), 0.32 - height * neck, -depth * neck],
        high: [Math.max(x0, x1), 0.32 + height * neck, depth * neck],
        kind: "body",
        side,
        along: middle,
        torn: k === 0 && share > 0.6 ? -side : 0,
      });
    }
    const x = side * (half + stretch + gap);
    boxes.push({
      low: [Math.min(x, x + side * 0.09), 0.32 - height * 1.35, -depth * 1.35],
      high: [Math.max(x, x + side * 0.09), 0.32 + height * 1.35, depth * 1.35],
      kind: "grip",
      side,
    });
  }
  return boxes;
}

function hit_box(eye, way, { low, high }) {
  let near = 1e-4,
    far = 1e9,
    axis = -1;
  for (let i = 0; i < 3; i++) {
    const inverse = 1 / way[i];
    let t0 = (low[i] - eye[i]) * inverse,
      t1 = (high[i] - eye[i]) * inverse;
    if (t0 > t1) [t0, t1] = [t1, t0];
    if (t0 > near) {
      near = t0;
      axis = i;
    }
    if (t1 < far) far = t1;
    if (near > far) return null;
  }
  return axis < 0 ? null : { distance: near, axis };
}

const around = (boxes) => ({
  low: [0, 1, 2].map((i) => Math.min(...boxes.map(({ low }) => low[i]))),
  high: [0, 1, 2].map((i) => Math.max(...boxes.map(({ high }) => high[i]))),
});

function color_of(box, normal, share, color) {
  if (box.kind === "grip") return STEEL;
  if (box.torn && normal[0] === box.torn) return CRACK;
  const damage = smooth(0.15, 0.65, share) * Math.exp(-((box.along / 0.25) ** 2)) * 1.1;
  if (color === "piece") return PIECES[box.side > 0 ? 1 : 0];
  if (color === "stress")
    return ramp(
      CIVIDIS,
      0.2 + 0.7 * Math.exp(-((box.along / 0.4) ** 2)) * (1 - 0.6 * smooth(0.6, 0.7, share)),
    );
  if (color === "speed") return ramp(CIVIDIS, box.along);
  if (color === "yielded") return damage > 0.2 ? DAMAGE[2] : DAMAGE[0];
  return color === "none" ? DAMAGE[0] : ramp(DAMAGE, damage);
}

/// RGB bytes of the view; `share` is the time through the run, 0..1.
export function draw(width, height, { eye, target, fov, color, theme }, share, shape = {}) {
  const forward = unit(sub(target, eye)),
    right = unit(cross(forward, [0, 1, 0])),
    up = cross(right, forward);
  const tangent = Math.tan((fov * Math.PI) / 360),
    boxes = boxes_of(share, shape);
  const all = around(boxes);
  const spans = [-1, 1]
    .map((side) => around(boxes.filter((box) => box.side === side)))
    .map(({ low, high }) => [low[0], high[0]]);
  const [inner, outer] = BACKDROP[theme] ?? BACKDROP.light,
    dark = theme === "dark";
  const ambient = dark ? 0.45 : 0.58,
    sun = dark ? 0.62 : 0.5;
  const rgb = Buffer.alloc(width * height * 3);
  for (let py = 0; py < height; py++) {
    for (let px = 0; px < width; px++) {
      const u = (((2 * (px + 0.5)) / width - 1) * tangent * width) / height,
        v = (1 - (2 * (py + 0.5)) / height) * tangent;
      const way = [0, 1, 2].map((i) => forward[i] + u * right[i] + v * up[i]);
      let best = null,
        chosen = null;
      for (const box of hit_box(eye, way, all) ? boxes : []) {
        const hit = hit_box(eye, way, box);
        if (hit && (!best || hit.distance < best.distance)) {
          best = hit;
          chosen = box;
        }
      }
      let pixel = mix(
        inner,
        outer,
        smooth(0, 1, Math.hypot((px / width - 0.5) / 0.75, (py / height - 0.36) / 0.8)),
      );
      if (best) {
        const normal = [0, 0, 0];
        normal[best.axis] = -Math.sign(way[best.axis]);
        const light = ambient + sun * Math.max(0, dot(normal, LIGHT)) + 0.08 * normal[1];
        pixel = color_of(chosen, normal, share, color).map((c) => c * light);
      } else if (way[1] < 0) {
        const t = -eye[1] / way[1],
          floor = [0, 1, 2].map((i) => eye[i] + t * way[i] + (0.32 * LIGHT[i]) / LIGHT[1]);
        const beyond = Math.min(
          ...spans.map(([low, high]) => Math.max(low - floor[0], 0, floor[0] - high)),
        );
        const reach =
          1 - smooth(0, 0.16, Math.hypot(beyond, Math.max(0, Math.abs(floor[2]) - 0.1)));
        pixel = pixel.map((c) => c * (1 - (dark ? 0.45 : 0.2) * reach));
      }
      for (let i = 0; i < 3; i++) rgb[(py * width + px) * 3 + i] = Math.min(255, pixel[i]);
    }
  }
  return rgb;
}

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n;
});
const crc32 = (bytes) =>
  ~bytes.reduce((crc, byte) => CRC_TABLE[(crc ^ byte) & 255] ^ (crc >>> 8), ~0) >>> 0;

function chunk(name, data) {
  const body = Buffer.concat([Buffer.from(name), data]),
    out = Buffer.alloc(body.length + 8);
  out.writeUInt32BE(data.length, 0);
  body.copy(out, 4);
  out.writeUInt32BE(crc32(body), body.length + 4);
  return out;
}

/// PNG bytes of an RGB picture.
export function to_png(width, height, rgb) {
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const rows = Buffer.alloc(height * (width * 3 + 1));
  for (let y = 0; y < height; y++)
    rgb.copy(rows, y * (width * 3 + 1) + 1, y * width * 3, (y + 1) * width * 3);
  return Buffer.concat([
    Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]),
    chunk("IHDR", head),
    chunk("IDAT", deflateSync(rows, { level: 1 })),
    chunk("IEND", Buffer.alloc(0)),
  ]);
}
