// Transport buttons, the timeline with its recorded bar and events, and the read-out.
import { find, make, set_icon, set_text } from "./element.js";
import { clamp } from "./quantity.js";

const share_at_thumb = (t) => `calc(${t} * (100% - 1rem) + .5rem)`;
const MODES = {
  preparing: "Preparing",
  stopped: "Stopped",
  finished: "Finished",
  paused: "Paused",
  playing: "Live",
};

export class Timeline {
  #playhead;
  #session;
  #drawn_events = "";

  constructor(session, playhead, picture) {
    this.#session = session;
    this.#playhead = playhead;
    const scrub = find("#scrub");
    const click = (id, action) => find(id).addEventListener("click", action);
    click("#play-button", () => playhead.toggle());
    click("#step-button", () => playhead.step());
    click("#back-button", () => playhead.seek(playhead.frame - 1));
    click("#reset-button", () => playhead.reset());
    click("#loop-button", () => playhead.toggle_loop());
    click("#newest-button", () => playhead.to_newest());
    find("#speed").addEventListener("change", (event) =>
      playhead.set_speed(Number(event.target.value)),
    );
    scrub.addEventListener("pointerdown", () => {
      playhead.scrubbing = true;
    });
    const release = () => {
      if (!playhead.scrubbing) return;
      playhead.scrubbing = false;
      picture.moved();
      this.#draw();
    };
    scrub.addEventListener("pointerup", release);
    scrub.addEventListener("pointercancel", release);
    scrub.addEventListener("input", () => playhead.seek(Number(scrub.value)));
    scrub.addEventListener("change", () => {
      release();
      this.#draw();
    });
    playhead.on("change", () => this.#draw());
    new ResizeObserver(() => {
      this.#drawn_events = "";
      this.#draw();
    }).observe(find("#events"));
  }

  #draw() {
    const state = this.#session.state;
    if (!state) return;
    const {
      frame,
      oldest,
      newest,
      total,
      time,
      playing,
      following,
      replaying,
      scrubbing,
      status,
      loop,
    } = this.#playhead;
    const scrub = find("#scrub");
    scrub.max = total;
    if (!scrubbing) scrub.value = frame;
    scrub.setAttribute(
      "aria-valuetext",
      `Frame ${frame} of ${total}, ${time.toFixed(2)} seconds, ${newest} recorded`,
    );
    find("#recorded").style.setProperty("--from", oldest ? share_at_thumb(oldest / total) : "0px");
    find("#recorded").style.setProperty("--to", share_at_thumb(newest / total));
    set_text(find("#read-frame"), String(frame));
    set_text(find("#read-frames"), ` / ${total}`);
    set_text(find("#read-time"), time.toFixed(3));

    const play = find("#play-button");
    set_icon(play, playing ? "pause" : "play");
    play.setAttribute("aria-label", playing ? "Pause" : "Play");
    find("#loop-button").setAttribute("aria-pressed", String(loop));
    find("#back-button").disabled = frame <= oldest;
    find("#step-button").disabled = following && !["paused", "playing"].includes(status);
    find("#newest-button").hidden = following;
    const live = following && status === "playing";
    set_text(
      find("#mode"),
      replaying ? "Replay" : following ? (MODES[status] ?? status) : "Recorded",
    );
    find("#mode").classList.toggle("live", live);
    this.#draw_events(state.events ?? [], total);
  }

  // Names that would run into each other give way to the later one; the mark stays.
  #draw_events(events, total) {
    const key = JSON.stringify([events, total]);
    if (key === this.#drawn_events) return;
    this.#drawn_events = key;
    const place = find("#events"),
      width = place.clientWidth;
    let free_until = Infinity;
    const nodes = [];
    for (const { frame, name } of [...events].sort((a, b) => b.frame - a.frame)) {
      const t = clamp(frame / total, 0, 1),
        half = name.length * 3.4 + 8;
      nodes.push(make("i", { "--at": `${t * 100}%`, title: name }));
      const x = clamp(t * width, half, Math.max(half, width - half));
      if (x + half > free_until) continue;
      free_until = x - half;
      const shift = t * width < half ? "0" : t * width > width - half ? "-100%" : "-50%";
      nodes.push(make("span", { "--at": `${t * 100}%`, "--shift": shift }, name));
    }
    place.replaceChildren(...nodes);
  }
}
