// Puts the page together.
import { find, fill_icons, set_text } from "./element.js";
import { get_json } from "./api.js";
import { Session } from "./session.js";
import { Playhead } from "./playhead.js";
import { OrbitCamera } from "./camera.js";
import { Picture } from "./picture.js";
import { Look } from "./look.js";
import { watch_gestures } from "./gestures.js";
import { ParameterPanel } from "./parameters.js";
import { Gallery } from "./scenes.js";
import { Timeline } from "./timeline.js";
import { Series } from "./series.js";
import { Plots } from "./plots.js";
import { Notices, toast } from "./notices.js";
import { watch_keys } from "./keyboard.js";
import { watch_panels } from "./panels.js";
import { watch_exports } from "./exports.js";
import { watch_upload } from "./upload.js";
import { show_stats } from "./stats.js";
import { Tools } from "./tools.js";
import { PullTool } from "./pull.js";
import { ProbeTool } from "./probe.js";
import { watch_links } from "./share.js";

fill_icons();
const report = (error) => toast(error.status ? error.message : "The server did not answer.");

const session = new Session();
const camera = new OrbitCamera();
const canvas = find("#picture");

// First of all listeners: the camera must know its home before anyone asks for a picture.
let home = "";
const find_home = (state) => {
  const seen = JSON.stringify([state.scene, state.camera]);
  if (!state.camera || seen === home) return;
  home = seen;
  camera.set_home(state.camera);
  camera.fit((canvas.clientWidth || 16) / (canvas.clientHeight || 9));
};
session.on("scene", find_home);
session.on("state", find_home);

const playhead = new Playhead(session, report);
const parameters = new ParameterPanel(session, toast);
const look = new Look(
  () => picture.refresh(),
  (revert) => parameters.remember(revert),
);

const picture = new Picture(canvas, session, playhead, camera, () => look.values());
session.on("scene", ({ view }) => look.adopt(view));
const series = new Series(session);
const gallery = new Gallery(session, playhead, toast);
new Timeline(session, playhead, picture);
new Plots(session, series, playhead);
new Notices(session, playhead, parameters);
show_stats(session, picture);

picture.on("shown", ({ legend }) => look.set_legend(legend));
const tools = new Tools(session);
const pull = new PullTool({ canvas, session, playhead, picture, camera, tools, toast });
new ProbeTool({ canvas, playhead, picture, tools });
watch_gestures(canvas, camera, {
  moved: () => {
    find("#hint").classList.add("gone");
    picture.moved();
    pull.draw();
  },
  take: (place) => pull.take(place),
  held: (held) => picture.hold(held),
});
find("#fit-button").addEventListener("click", () => {
  camera.fit(picture.aspect);
  picture.refresh();
});
const { hide_panels } = watch_panels();
watch_keys(playhead, { undo: () => parameters.undo(), hide_panels, tools });
watch_exports(session, playhead, picture, series, toast);

// Plays at once, but only the first time in this tab and never for who asked for less motion.
const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
if (!calm && !sessionStorage.getItem("started")) playhead.play_when_ready = true;
sessionStorage.setItem("started", "yes");

const listed = gallery.load();
watch_links({ session, playhead, picture, camera, look, parameters, gallery, toast, listed });
session.run();
get_json("/api/version")
  .then(({ version, renderer, lanes, capabilities = [] }) => {
    set_text(find("#about"), [`rend ${version}`, renderer, lanes].filter(Boolean).join(", "));
    if (capabilities.includes("upload")) watch_upload(gallery);
  })
  .catch(report);
