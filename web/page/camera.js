// An orbit camera about a target, y up; angles in radians, lengths in metres, fov vertical in degrees.

const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
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
    const [x, y, z] = eye.map((value, axis) => value - target[axis]);
    const length = Math.hypot(x, y, z) || 1;
    this.target = [...target];
    this.fov = fov;
    this.yaw = Math.atan2(x, z);
    this.pitch = clamp(Math.asin(y / length), -MOST_PITCH, MOST_PITCH);
    this.distance = length * Math.max(1, COMFORTABLE_ASPECT / aspect);
  }

  get backward() {
    const c = Math.cos(this.pitch);
    return [Math.sin(this.yaw) * c, Math.sin(this.pitch), Math.cos(this.yaw) * c];
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
    const right = [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
    const [bx, by, bz] = this.backward;
    const up = [by * right[2], bz * right[0] - bx * right[2], -by * right[0]];
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

  /// The camera as query values with six significant digits.
  query() {
    const list = (vector) => vector.map((value) => Number(value.toPrecision(6))).join(",");
    return { eye: list(this.eye), target: list(this.target), fov: String(this.fov) };
  }
}
