// Mouse, touch and keys on the picture move the camera, unless a tool takes the press.

const RADIANS_PER_PIXEL = 0.006;
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/// Calls `moved()` after every change of the camera, `held(true | false)` when the first pointer presses, the last
/// leaves. A first plain press is offered to `take(place)`, place {x, y} in shares of the picture: null leaves it to
/// the camera, else {wanted, move(place), end()}, where `wanted` promises whether the tool keeps it.
export function watch_gestures(canvas, camera, { moved, held, take = () => null }) {
  const pointers = new Map();
  let pinch = null,
    claim = null;

  const place_of = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: (event.clientX - box.x) / box.width, y: (event.clientY - box.y) / box.height };
  };
  const orbit = (dx, dy) => camera.orbit(-dx * RADIANS_PER_PIXEL, dy * RADIANS_PER_PIXEL);
  const offer = async (event) => {
    const mine = take(place_of(event));
    claim = mine && { ...mine, dx: 0, dy: 0, kept: false };
    const offered = claim;
    if (!offered) return;
    const kept = await offered.wanted.catch(() => false);
    if (offered !== claim) return;
    offered.kept = kept;
    if (kept) return held(false);
    // What the pointer did meanwhile was meant for the camera.
    claim = null;
    orbit(offered.dx, offered.dy);
    if (offered.dx || offered.dy) moved();
  };
  const drop_claim = () => {
    claim?.end();
    claim = null;
  };

  const center = () => {
    const all = [...pointers.values()];
    const x = all.reduce((sum, p) => sum + p.x, 0) / all.length;
    const y = all.reduce((sum, p) => sum + p.y, 0) / all.length;
    return {
      x,
      y,
      spread: all.length > 1 ? Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) : 0,
    };
  };
  const pan = (dx, dy) => camera.pan(dx / canvas.clientHeight, -dy / canvas.clientHeight);

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true, focusVisible: false });
    const moves = event.button === 1 || event.button === 2 || event.shiftKey;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, moves });
    pinch = pointers.size > 1 ? center() : null;
    canvas.classList.add("turning");
    held(true);
    drop_claim();
    if (pointers.size === 1 && !moves) offer(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const pointer = pointers.get(event.pointerId);
    if (!pointer) return;
    const dx = event.clientX - pointer.x,
      dy = event.clientY - pointer.y;
    pointer.x = event.clientX;
    pointer.y = event.clientY;
    if (claim) {
      if (claim.kept) claim.move(place_of(event));
      claim.dx += dx;
      claim.dy += dy;
      return;
    }
    if (pinch) {
      const now = center();
      pan(now.x - pinch.x, now.y - pinch.y);
      if (pinch.spread > 0 && now.spread > 0) camera.zoom(pinch.spread / now.spread);
      pinch = now;
    } else if (pointer.moves) {
      pan(dx, dy);
    } else {
      orbit(dx, dy);
    }
    if (dx || dy) moved();
  });
  const release = (event) => {
    if (!pointers.delete(event.pointerId)) return;
    drop_claim();
    pinch = pointers.size > 1 ? center() : null;
    if (pointers.size) return;
    canvas.classList.remove("turning");
    held(false);
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const pixels = event.deltaMode === 1 ? event.deltaY * 16 : event.deltaY;
      camera.zoom(Math.exp(Math.max(-300, Math.min(300, pixels)) * 0.0012));
      moved();
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const way = KEYS[event.key];
    if (way && event.shiftKey) camera.pan(-way[0] * 0.05, -way[1] * 0.05);
    else if (way) camera.orbit(way[0] * 0.08, way[1] * 0.06);
    else if (event.key === "+" || event.key === "=") camera.zoom(0.92);
    else if (event.key === "-") camera.zoom(1 / 0.92);
    else return;
    event.preventDefault();
    event.stopPropagation();
    moved();
  });
}
