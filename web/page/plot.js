// A small line plot on a canvas: some curves over frames and the playhead.

const DASHES = { solid: [], dashed: [3, 3], dotted: [1.5, 3] };

/// Curves are {values, color (a CSS variable), dash, top}; those without a `top` share one scale.
export class Plot {
  #canvas;
  #curves = [];
  #total = 1;
  #frame = 0;
  #waiting = false;

  /// `seek(frame)` hears a press or a drag in the plot.
  constructor(canvas, seek) {
    this.#canvas = canvas;
    const point = (event) => {
      const { left, width } = canvas.getBoundingClientRect();
      seek(Math.round(Math.min(1, Math.max(0, (event.clientX - left) / width)) * this.#total));
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      point(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) point(event);
    });
    new ResizeObserver(() => this.#later()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#later());
  }

  show(curves, frames, total, frame) {
    this.#curves = curves.map((curve) => ({ ...curve, frames }));
    this.#total = Math.max(total, 1);
    this.#frame = frame;
    this.#later();
  }

  #later() {
    if (this.#waiting) return;
    this.#waiting = true;
    requestAnimationFrame(() => {
      this.#waiting = false;
      this.#draw();
    });
  }

  #draw() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (!width || !height) return;
    const ratio = devicePixelRatio || 1,
      pen = this.#canvas.getContext("2d");
    this.#canvas.width = Math.round(width * ratio);
    this.#canvas.height = Math.round(height * ratio);
    pen.scale(ratio, ratio);
    const style = getComputedStyle(this.#canvas);
    const color = (name) => style.getPropertyValue(name).trim();
    const x = (frame) => 1 + (frame / this.#total) * (width - 2);

    pen.strokeStyle = color("--line");
    pen.strokeRect(0, height - 0.5, width, 0);
    const shared = this.#curves.filter(({ top }) => top === undefined);
    const common = this.#most(shared);
    const bottom = this.#least(shared);
    const place = (value, top, low) => height - 2 - ((value - low) / (top - low)) * (height - 5);
    if (bottom < 0) {
      const zero = place(0, common, bottom);
      pen.strokeRect(0, zero, width, 0);
    }
    for (const curve of this.#curves) {
      const top = curve.top ?? common,
        low = curve.top === undefined ? bottom : 0;
      pen.strokeStyle = color(curve.color);
      pen.lineWidth = 1.6;
      pen.lineJoin = "round";
      pen.setLineDash(DASHES[curve.dash ?? "solid"]);
      pen.beginPath();
      let down = false;
      curve.values.forEach((value, i) => {
        if (!Number.isFinite(value)) {
          down = false;
          return;
        }
        const y = place(value, top, low);
        if (down) pen.lineTo(x(curve.frames[i]), y);
        else pen.moveTo(x(curve.frames[i]), y);
        down = true;
      });
      pen.stroke();
    }
    pen.setLineDash([]);
    pen.strokeStyle = color("--accent");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(x(this.#frame), 0);
    pen.lineTo(x(this.#frame), height);
    pen.stroke();
  }

  #most(curves) {
    let most = 0;
    for (const { values } of curves) for (const value of values) if (value > most) most = value;
    return most || 1;
  }

  #least(curves) {
    let least = 0;
    for (const { values } of curves) for (const value of values) if (value < least) least = value;
    return least;
  }
}
