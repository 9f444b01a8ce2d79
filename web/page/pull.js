// Pulling at the body: a spring from the matter under the press to the pointer, or from the middle of the picture to where
// arrow keys put its end, drawn on the picture.
import { find, set_text } from "./element.js";
import { get_json, pause_for, send_json } from "./api.js";
import { shown_force } from "./tools.js";

const LEAST_GAP_MS = 25;
/// The server lets go of a spring that nobody has spoken of for 5 s.
const REMINDER_MS = 1000;
/// Shares of the picture's height.
const KEY_STEP = 0.03,
  FINE_KEY_STEP = 0.006;
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class PullTool {
  #canvas;
  #session;
  #playhead;
  #picture;
  #camera;
  #tools;
  #toast;
  #held = null;
  /// The grip that keys have taken; its place is where they have put the end of the spring.
  #key_press = null;
  #waiting = null;
  #busy = false;

  constructor({ canvas, session, playhead, picture, camera, tools, toast }) {
    this.#canvas = canvas;
    this.#session = session;
    this.#playhead = playhead;
    this.#picture = picture;
    this.#camera = camera;
    this.#tools = tools;
    this.#toast = toast;
    for (const source of [session, playhead])
      source.on(source === session ? "state" : "change", () => this.draw());
    picture.on("shown", () => this.draw());
    setInterval(() => {
      if (this.#held) this.#send({ target: this.#held.target });
    }, REMINDER_MS);
    addEventListener("pagehide", () => this.release());
    addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.release();
    });
    // Before the camera hears of them.
    canvas.addEventListener("keydown", (event) => this.#on_key(event), true);
    const let_go_of_keys = () => {
      if (this.#key_press) this.release();
    };
    canvas.addEventListener("blur", let_go_of_keys);
    tools.on("change", () => {
      if (tools.tool !== "pull") let_go_of_keys();
    });
  }

  /// A press at `place`, for watch_gestures.
  take(place) {
    if (this.#tools.tool !== "pull" || !this.#tools.radius) return null;
    if (this.#key_press) this.release();
    const press = { place, ended: false };
    this.#ring(place);
    return {
      wanted: this.#grab(press),
      move: (now) => this.#move(now),
      end: () => {
        press.ended = true;
        this.release();
      },
    };
  }

  #on_key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || this.#tools.tool !== "pull") return;
    const way = KEYS[event.key];
    if (event.key === "Enter" && !event.repeat) {
      if (this.#key_press) this.release();
      else this.#grab_middle();
    } else if (way && this.#key_press) {
      const { place } = this.#key_press;
      const step = event.shiftKey ? FINE_KEY_STEP : KEY_STEP;
      place.x += (way[0] * step) / this.#picture.aspect;
      place.y += way[1] * step;
      this.#move(place);
    } else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  async #grab_middle() {
    if (this.#held || !this.#tools.radius) return;
    const press = { place: { x: 0.5, y: 0.5 }, ended: false };
    this.#key_press = press;
    this.#ring(press.place);
    const kept = await this.#grab(press).catch(() => false);
    if (!kept && this.#key_press === press) this.release();
  }

  release() {
    if (this.#key_press) this.#key_press.ended = true;
    this.#key_press = null;
    if (this.#held) {
      this.#held = null;
      this.#send({ radius: 0 });
    }
    this.draw();
  }

  async #grab(press) {
    const { x, y } = press.place;
    const query = { ...this.#picture.view_query(), w: 1280, h: this.#height(), x, y };
    const { matter } = await get_json(
      `/api/probe?${new URLSearchParams({ ...query, frame: this.#playhead.wanted })}`,
    );
    if (!matter && press === this.#key_press)
      this.#toast("There is nothing to pull in the middle of the picture; turn or move the view.");
    if (!matter || press.ended || !this.#may_pull()) {
      this.draw();
      return false;
    }
    const { depth } = this.#camera.project(matter.position, this.#picture.aspect);
    this.#held = { at: matter.position, target: matter.position, depth };
    find("#hint").classList.add("gone");
    this.#send({ at: matter.position, target: matter.position });
    this.#playhead.to_newest();
    this.draw();
    return true;
  }

  #may_pull() {
    const { status } = this.#session.state ?? {};
    if (!this.#playhead.following) {
      this.#toast("Pulling works on the newest frame.", {
        label: "Go to newest",
        run: () => this.#playhead.to_newest(),
      });
      return false;
    }
    if (["finished", "stopped"].includes(status)) {
      this.#toast("The run has ended.", { label: "Reset to pull", run: () => this.#playhead.reset() });
      return false;
    }
    return status === "playing" || status === "paused";
  }

  #move({ x, y }) {
    if (!this.#held) return;
    this.#held.target = this.#camera.point_at({ x, y, depth: this.#held.depth }, this.#picture.aspect);
    this.#send({ target: this.#held.target });
    this.draw();
  }

  // The newest wins, one request in flight; a grip that was not sent yet goes with its first target.
  async #send(pull) {
    const begins = pull.radius === 0 ? undefined : (pull.at ?? this.#waiting?.at);
    this.#waiting = begins ? { ...pull, at: begins } : pull;
    if (this.#busy) return;
    this.#busy = true;
    while (this.#waiting) {
      const { radius, strength } = this.#tools;
      const body = { radius, strength, ...this.#waiting };
      this.#waiting = null;
      try {
        await send_json("POST", "/api/pull", body);
      } catch (error) {
        if (error.status && body.radius !== 0) {
          this.#held = null;
          this.#toast(error.message);
          this.draw();
        }
      }
      await pause_for(LEAST_GAP_MS);
    }
    this.#busy = false;
  }

  #height() {
    return Math.max(16, Math.round(1280 / this.#picture.aspect));
  }

  // Shown at once, before the server says whether there is matter.
  #ring(place) {
    const { clientWidth: w, clientHeight: h } = this.#canvas;
    this.#place({ x: place.x * w, y: place.y * h }, null, 22);
    find("#grip").classList.add("asking");
    find("#grip-force").hidden = true;
  }

  /// Ring, spring and force: of this page's grip, or of somebody else's.
  draw() {
    const told = this.#playhead.following ? this.#session.state?.pull : null;
    const pull = this.#held ? { force: [0, 0, 0], ...(told ?? {}), target: this.#held.target } : told;
    const grip = find("#grip"),
      pill = find("#grip-force");
    grip.classList.remove("asking");
    grip.toggleAttribute("hidden", !pull);
    pill.hidden = !pull;
    if (!pull) return;
    const aspect = this.#picture.aspect;
    const { clientWidth: w, clientHeight: h } = this.#canvas;
    const pixel = ({ x, y }) => ({ x: x * w, y: y * h });
    const at = this.#camera.project(pull.at ?? this.#held.at, aspect),
      target = this.#camera.project(pull.target, aspect);
    if (!(at.depth > 0 && target.depth > 0)) return grip.toggleAttribute("hidden", true);
    const metre = h / (2 * at.depth * Math.tan((this.#camera.fov * Math.PI) / 360));
    this.#place(pixel(at), pixel(target), (pull.radius ?? this.#tools.radius) * metre);
    set_text(pill, shown_force(Math.hypot(...pull.force)));
    const beside = pixel(target);
    pill.style.setProperty("--x", `${Math.max(8, Math.min(beside.x + 18, w - 88))}px`);
    pill.style.setProperty("--y", `${Math.max(8, Math.min(beside.y - 14, h - 36))}px`);
  }

  #place(at, target, radius) {
    const grip = find("#grip");
    grip.toggleAttribute("hidden", false);
    const set = (selector, values) => {
      for (const [name, value] of Object.entries(values))
        find(selector, grip).setAttribute(name, value.toFixed(1));
    };
    set("circle.reach", { cx: at.x, cy: at.y, r: Math.max(6, radius) });
    const end = target ?? at;
    set("line", { x1: at.x, y1: at.y, x2: end.x, y2: end.y });
    set("circle.hold", { cx: end.x, cy: end.y, r: 6 });
  }
}
