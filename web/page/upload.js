// A mesh by drop or file dialog: sent with progress, refused with its reason, opened when it is ready.
import { find, make } from "./element.js";
import { send_file } from "./api.js";

const MOST_BYTES = 64 * 1024 * 1024;

export function watch_upload(gallery) {
  const note = find("#upload-note"),
    picker = find("#upload-file"),
    veil = find("#veil");
  find("#upload-button").hidden = false;

  // Only the newest upload may write the note: an older one can end after it.
  let newest = 0;
  const say = (turn, kind, title, text, ...more) =>
    turn === newest &&
    note.replaceChildren(
      make(
        "div",
        { class: `upload-note ${kind}` },
        make("b", {}, title),
        text ? make("div", {}, text) : "",
        ...more,
      ),
    );

  async function load(file) {
    if (!file) return;
    const turn = ++newest;
    if (file.size > MOST_BYTES)
      return say(turn, "refused", `${file.name} is too large.`, "At most 64 MB can be loaded.");
    const bar = make("progress", { max: 1, "aria-label": `Sending ${file.name}` });
    say(turn, "", `Sending ${file.name}`, "", bar);
    try {
      const { name, notes = [] } = await send_file(
        `/api/meshes?name=${encodeURIComponent(file.name)}`,
        file,
        (share) => {
          if (share < 1) bar.value = share;
          else bar.removeAttribute("value");
        },
      );
      await gallery.load();
      if (gallery.names().includes(name)) await gallery.open(name);
      if (notes.length) say(turn, "", `${file.name} is loaded.`, notes.join(" "));
      else if (turn === newest) note.replaceChildren();
    } catch (error) {
      say(turn, "refused", `${file.name} was not taken.`, error.message);
    }
  }

  find("#upload-button").addEventListener("click", () => picker.click());
  picker.addEventListener("change", () => {
    load(picker.files[0]);
    picker.value = "";
  });
  const carries_file = (event) => event.dataTransfer?.types.includes("Files");
  addEventListener("dragover", (event) => {
    if (!carries_file(event)) return;
    event.preventDefault();
    veil.hidden = false;
  });
  addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) veil.hidden = true;
  });
  addEventListener("drop", (event) => {
    if (!carries_file(event)) return;
    event.preventDefault();
    veil.hidden = true;
    load(event.dataTransfer.files[0]);
  });
}
