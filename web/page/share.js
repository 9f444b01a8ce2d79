// A link to what is seen: scene, changed values, view and frame in the address, and back.
import { find } from "./element.js";
import { send_json } from "./api.js";

const VALUE = "set:";

/// Reads a link's hash: {scene, frame, camera, look, values}; missing or broken parts are left out.
export function read_link(hash) {
  const query = new URLSearchParams(hash.replace(/^#/, ""));
  const vector = (name) => {
    const numbers = (query.get(name) ?? "").split(",").map(Number);
    return numbers.length === 3 && numbers.every(Number.isFinite) && query.get(name) ? numbers : null;
  };
  const eye = vector("eye"),
    target = vector("target"),
    fov = Number(query.get("fov"));
  const values = {};
  for (const [name, text] of query)
    if (name.startsWith(VALUE) && Number.isFinite(Number(text)))
      values[name.slice(VALUE.length)] = Number(text);
  const frame = Number(query.get("frame") ?? NaN);
  return {
    scene: query.get("scene"),
    frame: Number.isInteger(frame) && frame >= 0 ? frame : null,
    camera: eye && target && fov >= 1 && fov <= 120 ? { eye, target, fov } : null,
    look: {
      ...(query.get("color") && { color: query.get("color") }),
      ...(query.get("mode") && { mode: query.get("mode") }),
    },
    values,
  };
}

export function write_link({ scene, frame, view, values }) {
  const query = new URLSearchParams({ scene, frame, ...view });
  for (const [id, value] of Object.entries(values)) query.set(VALUE + id, value);
  return `#${query.toString().replaceAll("%2C", ",").replaceAll("%2F", "/").replaceAll("%3A", ":")}`;
}

/// The button that copies, and a link that the page was opened with.
export function watch_links({ session, playhead, picture, camera, look, parameters, gallery, toast, listed }) {
  find("#link-button").addEventListener("click", async () => {
    const { theme, ...view } = picture.view_query();
    const { scene } = session.state ?? {};
    if (!scene) return;
    const hash = write_link({ scene, frame: playhead.frame, view, values: parameters.changed() });
    history.replaceState(null, "", hash);
    try {
      await navigator.clipboard.writeText(location.href);
      toast("Link copied.");
    } catch {
      toast("The link is in the address bar.");
    }
  });

  const link = read_link(location.hash);
  if (!link.scene) return;
  let opened = false,
    asked = false;
  const open = async (state) => {
    if (opened) return;
    if (state.scene !== link.scene) {
      if (asked) return;
      asked = true;
      await listed;
      if (gallery.names().includes(link.scene)) gallery.open(link.scene);
      else toast(`There is no scene ${link.scene} on this server.`);
      return;
    }
    if (!state.camera || state.status === "preparing") return;
    opened = true;
    try {
      if (Object.keys(link.values).length)
        await send_json("PATCH", "/api/parameters", { values: link.values });
      parameters.load();
    } catch (error) {
      toast(error.message);
    }
    if (link.camera) camera.look(link.camera);
    look.adopt(link.look);
    picture.refresh();
    go_to_frame();
  };
  session.on("state", open);

  // The run gets to the frame of the link and stops there, unless somebody takes over.
  function go_to_frame() {
    if (link.frame === null) return;
    const forget = () => {
      link.frame = null;
    };
    for (const kind of ["pointerdown", "keydown"]) addEventListener(kind, forget, { once: true });
    const look_for_it = ({ frame, status }) => {
      if (link.frame === null || frame < link.frame) return;
      const wanted = link.frame;
      forget();
      playhead.seek(wanted);
    };
    session.on("state", look_for_it);
    look_for_it(session.state);
  }
}
