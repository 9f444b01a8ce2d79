// Fetches the picture, at most one request in flight, and draws it on the canvas.
import { Emitter } from "./emitter.js";
import { get_picture, pause_for } from "./api.js";

const POLL_MS = 2000;
const STILL_AFTER_MS = 150;
const MOST_LIVE_PIXELS = 1.3e6;
const MOST_STILL_PIXELS = 2.1e6;

/// Events: "shown" {frame, legend}.
export class Picture extends Emitter {
  theme = matchMedia("(prefers-color-scheme: dark)");
  rate = 0;
  #canvas;
  #playhead;
  #camera;
  #look;
  #session;
  #in_flight = null;
  #shown_key = "";
  #token = "";
  #stale = false;
  #moving = false;
  #held = false;
  #still_timer = 0;
  #arrivals = [];

  /// `look()` gives {color, mode}.
  constructor(canvas, session, playhead, camera, look) {
    super();
    this.#canvas = canvas;
    this.#session = session;
    this.#playhead = playhead;
    this.#camera = camera;
    this.#look = look;
    canvas.classList.add("empty");
    let revision = -1;
    session.on("state", (state) => {
      if (state.revision !== revision) this.#stale = true;
      revision = state.revision;
      this.refresh();
    });
    session.on("scene", () => {
      this.#token = "";
      this.#shown_key = "";
    });
    session.on("found", () => {
      this.#stale = true;
    });
    playhead.on("change", () => this.refresh());
    this.theme.addEventListener("change", () => this.refresh());
    document.addEventListener("visibilitychange", () => this.refresh());
    new ResizeObserver(() => this.refresh()).observe(canvas);
  }

  get aspect() {
    return (this.#canvas.clientWidth || 16) / (this.#canvas.clientHeight || 9);
  }

  /// The camera is being moved: small fast pictures until 150 ms after the last call.
  moved() {
    this.#moving = true;
    clearTimeout(this.#still_timer);
    this.#still_timer = setTimeout(() => {
      if (this.#held) return;
      this.#moving = false;
      this.refresh();
    }, STILL_AFTER_MS);
    this.refresh();
  }

  /// While a pointer holds the picture, pauses of the hand bring no still.
  hold(held) {
    this.#held = held;
    if (!held && this.#moving) this.moved();
  }

  /// The view as query values; `size` overrides the picture's own pixel size.
  view_query(size = {}) {
    const { color, mode } = this.#look();
    return {
      ...this.#camera.query(),
      color,
      mode,
      theme: this.theme.matches ? "dark" : "light",
      ...size,
    };
  }

  /// Looks whether another picture is wanted, and starts its request if none is in flight.
  refresh() {
    if (this.#in_flight) {
      const { waits, slow, key } = this.#in_flight;
      if ((waits || slow) && key !== this.#wish().key) this.#in_flight.abort.abort();
      return;
    }
    const job = this.#next();
    if (job) this.#fetch(job);
  }

  #wish() {
    const hurried = this.#moving || this.#playhead.scrubbing;
    const still = !hurried && !this.#playhead.playing;
    const ratio = Math.min(devicePixelRatio || 1, 2) * (hurried ? 0.5 : 1);
    let w = this.#canvas.clientWidth * ratio,
      h = this.#canvas.clientHeight * ratio;
    const shrink = Math.min(1, Math.sqrt((still ? MOST_STILL_PIXELS : MOST_LIVE_PIXELS) / (w * h)));
    w = Math.round((w * shrink) / 2) * 2;
    h = Math.round((h * shrink) / 2) * 2;
    const query = {
      frame: this.#playhead.wanted,
      w,
      h,
      ...this.view_query(),
      legend: 0,
      quality: still ? "still" : "fast",
    };
    return { query, still, key: new URLSearchParams(query).toString() };
  }

  #next() {
    const state = this.#session.state;
    if (!state || !this.#session.connected || document.hidden || !this.#canvas.clientWidth)
      return null;
    const { query, still, key } = this.#wish();
    if (key !== this.#shown_key) return { query, key, slow: still, waits: false };
    const live = this.#playhead.following && state.status === "playing";
    if (!live && !this.#stale) return null;
    this.#stale = false;
    return {
      query: { ...query, after: this.#token, wait: POLL_MS },
      key,
      slow: false,
      waits: true,
    };
  }

  async #fetch({ query, key, slow, waits }) {
    const abort = new AbortController();
    this.#in_flight = { abort, slow, waits, key };
    try {
      const signal = AbortSignal.any([abort.signal, AbortSignal.timeout(15000)]);
      const answer = await get_picture(`/api/frame.jpg?${new URLSearchParams(query)}`, { signal });
      if (answer) {
        await this.#show(answer, Number(query.frame));
        this.#token = answer.headers.get("x-token") ?? "";
        this.#shown_key = key;
      } else if (!waits) {
        await pause_for(250);
      }
    } catch (error) {
      if (error.name !== "AbortError") await pause_for(500);
    }
    this.#in_flight = null;
    this.refresh();
  }

  async #show({ blob, headers }, wanted) {
    const bitmap = await createImageBitmap(blob);
    this.#canvas.width = bitmap.width;
    this.#canvas.height = bitmap.height;
    this.#canvas.getContext("2d", { alpha: false }).drawImage(bitmap, 0, 0);
    bitmap.close();
    this.#canvas.classList.remove("empty");
    this.#count_arrival();
    this.emit("shown", {
      frame: Number(headers.get("x-frame") ?? wanted),
      legend: headers.get("x-legend"),
    });
  }

  #count_arrival() {
    const now = performance.now();
    this.#arrivals.push(now);
    while (now - this.#arrivals[0] > 2000) this.#arrivals.shift();
    const span = (now - this.#arrivals[0]) / 1000;
    this.rate = span > 0.2 ? (this.#arrivals.length - 1) / span : 0;
  }
}
