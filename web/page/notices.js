// Rows above the picture (stopped run, energy out of bounds, lost connection), the preparing pill, notes, and short messages.
import { find, icon, make, set_text } from "./element.js";

const SHOWN_MS = 5000;
const STAGE_NAMES = {
  sample: "Placing particles",
  mesh: "Building the mesh",
  import: "Reading the mesh",
};

let toast_timer = 0;

/// A short message at the bottom; `action` is {label, run}.
export function toast(text, action) {
  const node = find("#toast");
  node.replaceChildren(
    text,
    ...(action ? [make("button", { on_click: action.run }, action.label)] : []),
  );
  node.classList.add("on");
  clearTimeout(toast_timer);
  toast_timer = setTimeout(() => node.classList.remove("on"), SHOWN_MS);
}

export class Notices {
  #session;
  #playhead;
  #parameters;
  #dismissed = "";
  #warned = "";
  #shown = "";

  constructor(session, playhead, parameters) {
    this.#session = session;
    this.#playhead = playhead;
    this.#parameters = parameters;
    session.on("state", (state) => {
      this.#draw_stopped(state);
      this.#draw_warning(state);
      this.#draw_preparing(state);
      this.#draw_notes(state.notes ?? []);
    });
    session.on("lost", ({ seconds }) => this.#draw_lost(seconds));
    session.on("found", () => {
      find("#lost").hidden = true;
      find("#picture").classList.remove("stale");
    });
    find("#lost-retry").addEventListener("click", () => session.try_now());
  }

  #draw_lost(seconds) {
    find("#lost").hidden = false;
    find("#picture").classList.add("stale");
    const frame = this.#session.state ? ` This is frame ${this.#playhead.frame}.` : "";
    set_text(find("#lost-text"), `Connection lost.${frame}`);
    set_text(find("#lost-wait"), `Trying again in ${seconds} s.`);
  }

  #draw_stopped(state) {
    const banner = find("#stopped"),
      stopped = state.status === "stopped";
    const key = stopped ? JSON.stringify([state.scene, state.reason, state.message]) : "";
    if (!stopped) this.#dismissed = "";
    banner.hidden = !stopped || key === this.#dismissed;
    if (key === this.#shown) return;
    this.#shown = key;
    if (!stopped) return banner.replaceChildren();
    if (!state.reason) return banner.replaceChildren(...this.#refusal(state, key));
    const frame = state.reason.frame;
    const good = Math.min(state.frame, frame);
    banner.replaceChildren(
      icon("warn"),
      make(
        "div",
        {},
        make("b", {}, `The run stopped at frame ${frame}.`),
        make("p", {}, state.reason.text, ` Frame ${good} is the last good one and is kept.`),
      ),
      make("div", { class: "row" }, ...this.#ways_out(good), this.#dismiss(key)),
    );
  }

  // Once per scene: the words carry figures that change with every frame.
  #draw_warning({ scene, energy_warning: text, status }) {
    const banner = find("#energy-warning"),
      kind = text ? `${scene} ${text.includes("gained") ? "gain" : "loss"}` : "";
    if (!text) this.#warned = "";
    banner.hidden = !text || kind === this.#warned || status === "stopped";
    if (banner.hidden) return banner.replaceChildren();
    const words = banner.querySelector("p");
    if (words) return set_text(words, text);
    const dismiss = () => {
      this.#warned = kind;
      banner.hidden = true;
      banner.replaceChildren();
    };
    banner.replaceChildren(
      icon("warn"),
      make("div", {}, make("b", {}, "The energy balance is out of bounds."), make("p", {}, text)),
      make("div", { class: "row" }, this.#button("button", null, dismiss, "Dismiss the warning")),
    );
  }

  #refusal({ message }, key) {
    return [
      icon("warn"),
      make("div", {}, make("b", {}, "The scene did not load."), make("p", {}, message ?? "")),
      make("div", { class: "row" }, this.#dismiss(key)),
    ];
  }

  #dismiss(key) {
    return this.#button(
      "button",
      null,
      () => {
        this.#dismissed = key;
        find("#stopped").hidden = true;
      },
      "Dismiss",
    );
  }

  #ways_out(good) {
    const look = () => this.#playhead.seek(good);
    const again = () => this.#playhead.reset();
    const courant = ["cfl", "solver.cfl", "/solver/cfl"].find((id) => this.#parameters.has(id));
    if (!courant) {
      return [
        this.#button("button main", "Start again", again),
        this.#button("button", `Look at frame ${good}`, look),
      ];
    }
    const smaller = () => {
      this.#parameters.set(courant, this.#parameters.value_of(courant) / 2);
      again();
    };
    return [
      this.#button("button main", "Halve the time step, start again", smaller),
      this.#button("button", "Start again", again),
      this.#button("button", `Look at frame ${good}`, look),
    ];
  }

  #button(kind, text, run, label = null) {
    const button = make("button", { class: kind, "aria-label": label, on_click: run });
    button.append(text ?? icon("close"));
    return button;
  }

  #draw_preparing(state) {
    const preparing = state.status === "preparing";
    find("#preparing").hidden = !preparing;
    if (!preparing) return;
    const { stage, share } = state.progress ?? {};
    const count = state.particles ? `, ${state.particles.toLocaleString("en")} particles` : "";
    set_text(
      find("#preparing-text"),
      `${STAGE_NAMES[stage] ?? stage ?? state.message ?? "Preparing"}${count}`,
    );
    const bar = find("#preparing-bar");
    if (Number.isFinite(share)) bar.value = share;
    else bar.removeAttribute("value");
  }

  #draw_notes(notes) {
    find("#notes").hidden = !notes.length;
    if (find("#notes-list").children.length === notes.length) return;
    find("#notes-list").replaceChildren(...notes.map((note) => make("li", {}, note)));
  }
}
