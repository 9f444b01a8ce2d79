// An orbit camera about a target, y up; angles in radians, lengths in metres, fov vertical in degrees.

const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const MOST_PITCH = 1.53;
/// Below this aspect (width / height) the picture's width decides, so Fit steps back.
const COMFORTABLE_ASPECT = 1.5;

export class OrbitCamera {
  target = [0, 0, 0];
  yaw = 0;
  pitch = 0.3;
  distance = 3;
  fov = 30;
  #home = null;

  /// Takes over the scene's camera as the one that `fit` returns to.
  set_home({ eye, target, fov }) {
    this.#home = { eye, target, fov };
  }

  fit(aspect) {
    if (!this.#home) return;
    const { eye, target, fov } = this.#home;
    this.#aim(eye, target, fov);
    this.distance *= Math.max(1, COMFORTABLE_ASPECT / aspect);
  }

  #aim(eye, target, fov) {
    const [x, y, z] = eye.map((value, axis) => value - target[axis]);
    const length = Math.hypot(x, y, z) || 1;
    this.target = [...target];
    this.fov = fov;
    this.yaw = Math.atan2(x, z);
    this.pitch = clamp(Math.asin(y / length), -MOST_PITCH, MOST_PITCH);
    this.distance = length;
  }

  get backward() {
    const c = Math.cos(this.pitch);
    return [Math.sin(this.yaw) * c, Math.sin(this.pitch), Math.cos(this.yaw) * c];
  }

  get right() {
    return [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
  }

  get up() {
    const [bx, by, bz] = this.backward,
      right = this.right;
    return [by * right[2], bz * right[0] - bx * right[2], -by * right[0]];
  }

  get eye() {
    return this.backward.map((value, axis) => this.target[axis] + this.distance * value);
  }

  orbit(radians_right, radians_up) {
    this.yaw += radians_right;
    this.pitch = clamp(this.pitch + radians_up, -MOST_PITCH, MOST_PITCH);
  }

  /// Moves the target by a shift on the screen, as shares of the picture's height.
  pan(right_share, up_share) {
    const height = 2 * this.distance * Math.tan((this.fov * Math.PI) / 360);
    const { right, up } = this;
    this.target = this.target.map(
      (value, axis) => value - height * (right[axis] * right_share + up[axis] * up_share),
    );
  }

  zoom(factor) {
    const home = this.#home
      ? Math.hypot(...this.#home.eye.map((v, i) => v - this.#home.target[i]))
      : 3;
    this.distance = clamp(this.distance * factor, home / 12, home * 6);
  }

  /// Where a point lies in a picture of this aspect: {x, y} as shares from its top left, and its view depth.
  project(point, aspect) {
    const away = point.map((value, axis) => value - this.eye[axis]);
    const depth = -dot(away, this.backward),
      half = depth * Math.tan((this.fov * Math.PI) / 360);
    return {
      x: 0.5 + dot(away, this.right) / (2 * half * aspect),
      y: 0.5 - dot(away, this.up) / (2 * half),
      depth,
    };
  }

  /// The point at a view depth under (x, y), shares of a picture of this aspect.
  point_at({ x, y, depth }, aspect) {
    const half = depth * Math.tan((this.fov * Math.PI) / 360);
    const { eye, right, up, backward } = this;
    return eye.map(
      (value, axis) =>
        value -
        depth * backward[axis] +
        (2 * x - 1) * half * aspect * right[axis] +
        (1 - 2 * y) * half * up[axis],
    );
  }

  /// Looks as another camera does.
  look({ eye, target, fov }) {
    this.#aim(eye, target, fov);
  }

  /// The camera as query values with six significant digits.
  query() {
    const list = (vector) => vector.map((value) => Number(value.toPrecision(6))).join(",");
    return { eye: list(this.eye), target: list(this.target), fov: String(this.fov) };
  }
}
