// The gallery of scenes: thumbnails, the current one, loading another.
import { find, find_all, make, set_text } from "./element.js";
import { get_json, get_picture, pause_for, send_json } from "./api.js";

const THUMB_RETRY_MS = [1500, 3000, 6000, 12000, 24000];

/// A file-like name as a heading; titles of their own stay as they are.
const heading_of = ({ name, scene = name, title }) => {
  if (title && title !== scene) return title;
  const words = scene.replaceAll(/[-_]+/g, " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
};

export class Gallery {
  #session;
  #playhead;
  #toast;
  #pictures = new Map();
  #theme = matchMedia("(prefers-color-scheme: dark)");
  #round = 0;

  constructor(session, playhead, toast) {
    this.#session = session;
    this.#playhead = playhead;
    this.#toast = toast;
    session.on("scene", (state) => {
      const heading = heading_of(state);
      set_text(find("#scene-title"), heading);
      set_text(find("#scene-note"), state.description ?? "");
      document.title = `rend: ${heading}`;
      find("#picture").setAttribute(
        "aria-label",
        `Picture of ${heading}. Arrow keys turn it, plus and minus zoom.`,
      );
    });
    let seen = "";
    session.on("state", (state) => {
      this.#mark(state);
      // Another status is a good moment for a newer thumbnail of the current scene.
      const now = `${state.scene} ${state.status}`;
      if (now !== seen && seen && state.status !== "preparing")
        this.#fetch_thumb(state.scene, this.#round);
      seen = now;
    });
    session.on("found", () => this.load());
    this.#theme.addEventListener("change", () => this.load());
  }

  async load() {
    const round = ++this.#round;
    try {
      const { scenes } = await get_json("/api/scenes");
      find("#scenes").replaceChildren(...scenes.map((scene) => this.#item(scene)));
      if (this.#session.state) this.#mark(this.#session.state);
      for (const scene of scenes) this.#fetch_thumb(scene.name, round);
    } catch (error) {
      if (error.status) this.#toast(error.message);
    }
  }

  names() {
    return find_all(".scene").map((node) => node.dataset.name);
  }

  async open(name) {
    const button = find(`.scene[data-name="${CSS.escape(name)}"]`);
    this.#playhead.play_when_ready = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (button) this.#select(name);
    find("#upload-note").replaceChildren();
    try {
      await send_json("POST", "/api/scene", { name });
    } catch (error) {
      this.#playhead.play_when_ready = false;
      this.#toast(error.message);
      if (this.#session.state) this.#select(this.#session.state.scene);
    }
  }

  #item({ name, title, description }) {
    const thumb = make("span", { class: "thumb" });
    const known = this.#pictures.get(name);
    if (known) thumb.append(make("img", { src: known, alt: "" }));
    return make(
      "li",
      {},
      make(
        "button",
        {
          class: "scene",
          "data-name": name,
          "aria-current": "false",
          title: description || heading_of({ name, title }),
          on_click: () => this.open(name),
        },
        thumb,
        make("span", { class: "title" }, heading_of({ name, title })),
      ),
    );
  }

  #select(name) {
    for (const node of find_all(".scene"))
      node.setAttribute("aria-current", String(node.dataset.name === name));
  }

  #mark(state) {
    this.#select(state.scene);
    for (const node of find_all(".scene")) {
      const busy = node.dataset.name === state.scene && state.status === "preparing";
      let bar = find("progress", node);
      if (!busy) {
        bar?.remove();
        continue;
      }
      if (!bar) {
        bar = make("progress", { max: 1, "aria-label": "Preparing" });
        find(".thumb", node).append(bar);
      }
      if (Number.isFinite(state.progress?.share)) bar.value = state.progress.share;
    }
  }

  async #fetch_thumb(name, round) {
    const theme = this.#theme.matches ? "dark" : "light";
    for (const wait of THUMB_RETRY_MS) {
      if (round !== this.#round) return;
      try {
        const answer = await get_picture(
          `/api/scenes/${encodeURIComponent(name)}/thumb.jpg?theme=${theme}`,
        );
        if (answer) return this.#show_thumb(name, answer.blob);
      } catch {
        // The next round asks again: a missing thumbnail is not worth a message.
      }
      await pause_for(wait);
    }
  }

  #show_thumb(name, blob) {
    URL.revokeObjectURL(this.#pictures.get(name) ?? "");
    const url = URL.createObjectURL(blob);
    this.#pictures.set(name, url);
    const thumb = find(`.scene[data-name="${CSS.escape(name)}"] .thumb`);
    if (!thumb) return;
    find("img", thumb)?.remove();
    thumb.prepend(make("img", { src: url, alt: "" }));
  }
}
