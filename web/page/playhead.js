// Where in time the page looks: at the newest frame, or at a recorded one, still or replayed.
import { Emitter } from "./emitter.js";

/// Events: "change".
export class Playhead extends Emitter {
  following = true;
  replaying = false;
  scrubbing = false;
  speed = 1;
  loop = false;
  play_when_ready = false;
  #frame = 0;
  #session;
  #report;
  #last_time = 0;

  /// `report` hears errors of actions.
  constructor(session, report) {
    super();
    this.#session = session;
    this.#report = report;
    session.on("state", (state) => this.#follow_state(state));
    session.on("scene", () => this.#go_live());
  }

  get newest() {
    return this.#session.state?.frame ?? 0;
  }
  get oldest() {
    return Math.min(this.#session.state?.first_frame ?? 0, this.newest);
  }
  get total() {
    return Math.max(this.#session.state?.frames ?? 0, this.newest, 1);
  }
  get frame() {
    return this.following ? this.newest : Math.max(this.oldest, Math.min(this.#frame, this.newest));
  }
  get status() {
    return this.#session.state?.status ?? "preparing";
  }
  get playing() {
    return this.replaying || (this.following && this.status === "playing");
  }
  get time() {
    const state = this.#session.state;
    if (!state) return 0;
    return this.following ? (state.time ?? 0) : this.frame / (state.frame_rate || 24);
  }
  /// "live" or a number, as the frame request wants it.
  get wanted() {
    return this.following ? "live" : this.frame;
  }

  toggle() {
    this.playing ? this.pause() : this.play();
  }

  play() {
    this.play_when_ready = false;
    if (!this.following && this.frame < this.newest) return this.#replay();
    if (["finished", "stopped"].includes(this.status) || this.newest >= this.total) {
      this.#frame = this.oldest;
      this.following = false;
      return this.#replay();
    }
    this.following = true;
    if (this.status === "paused") this.#act("play", {}, { status: "playing" });
    else if (this.status === "preparing") this.play_when_ready = true;
    this.emit("change");
  }

  pause() {
    this.play_when_ready = false;
    if (this.replaying) this.#frame = this.frame;
    this.replaying = false;
    if (this.status === "playing") this.#act("pause", {}, { status: "paused" });
    this.emit("change");
  }

  /// Looks at frame `n`, paused; the newest one when `n` lies beyond.
  seek(n) {
    const to_newest = n >= this.newest;
    this.replaying = false;
    this.#frame = Math.max(this.oldest, Math.min(Math.round(n), this.newest));
    this.following = to_newest;
    if (this.status === "playing") this.#act("pause", {}, { status: "paused" });
    this.emit("change");
  }

  /// One frame on: a recorded one, or a newly simulated one at the end.
  step() {
    if (!this.following && this.frame < this.newest) return this.seek(this.frame + 1);
    if (this.status === "playing") return this.pause();
    if (this.status === "paused") this.#act("step", { frames: 1 });
  }

  move(frames) {
    if (frames === 1) this.step();
    else this.seek(this.frame + frames);
  }

  to_newest() {
    this.#go_live();
  }

  reset() {
    this.#go_live();
    this.#act("reset");
  }

  set_speed(speed) {
    this.speed = speed;
  }

  toggle_loop() {
    this.loop = !this.loop;
    this.emit("change");
  }

  #go_live() {
    this.following = true;
    this.replaying = false;
    this.emit("change");
  }

  #replay() {
    this.replaying = true;
    this.#last_time = performance.now();
    let carried = 0;
    const tick = (now) => {
      if (!this.replaying) return;
      const rate = (this.#session.state?.frame_rate || 24) * this.speed;
      carried += Math.min(0.25, (now - this.#last_time) / 1000) * rate;
      this.#last_time = now;
      if (carried >= 1) {
        this.#frame += Math.floor(carried);
        carried %= 1;
        if (this.#frame >= this.newest) this.#end_of_record();
        this.emit("change");
      }
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
    this.emit("change");
  }

  #end_of_record() {
    if (this.loop && this.status !== "playing") {
      this.#frame = this.oldest;
      return;
    }
    this.replaying = false;
    this.following = true;
    if (this.status === "paused") this.#act("play", {}, { status: "playing" });
  }

  #follow_state(state) {
    if (!this.following && this.#frame > state.frame) this.#go_live();
    if (this.play_when_ready && state.status === "paused") this.play();
    else if (state.status === "playing" || state.status === "stopped") this.play_when_ready = false;
    if (this.loop && this.following && state.status === "finished") this.play();
    this.emit("change");
  }

  #act(name, body, expected) {
    this.#session.act(name, body, expected).catch(this.#report);
  }
}
