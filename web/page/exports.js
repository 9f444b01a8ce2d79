// Downloads: pictures and meshes of one frame or of all, the table of the run.
import { find, find_all, make, set_text } from "./element.js";
import { ExportJob } from "./export_job.js";

const PICTURE_WIDTH = 1920;

function download(href, name) {
  const link = make("a", { href, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}

export function watch_exports(session, playhead, picture, series, toast) {
  const stem = () => `${session.state?.scene ?? "rend"}-${String(playhead.frame).padStart(4, "0")}`;
  const size = () => ({
    w: PICTURE_WIDTH,
    h: Math.min(2160, Math.round(PICTURE_WIDTH / picture.aspect / 2) * 2),
  });
  const job = new ExportJob(toast, download);
  const format = find("#export-format");
  const all_frames = () => find("[name=export-range]:checked").value === "all";
  const range = () => ({ first: playhead.oldest, last: playhead.newest });
  const save_picture = () => {
    const query = new URLSearchParams({ ...picture.view_query(size()), quality: "still" });
    download(`/api/frames/${playhead.frame}.png?${query}`, `${stem()}.png`);
    toast(`Saving ${stem()}.png`);
  };
  const save_mesh = () => {
    const ending = format.value;
    download(`/api/frames/${playhead.frame}/mesh.${ending}`, `${stem()}.${ending}`);
    toast(`Saving ${stem()}.${ending}`);
  };
  const save_all = (ending) => job.start({ format: ending, ...range() }, picture.view_query(size()));
  const save_table = () => {
    const url = URL.createObjectURL(new Blob([series.csv()], { type: "text/csv" }));
    download(url, `${session.state?.scene ?? "rend"}.csv`);
    setTimeout(() => URL.revokeObjectURL(url), 10000);
    toast(`Saved ${series.frames.length} rows`);
  };
  const pop = find("#export");
  const say_what = () => {
    const { w, h } = size(),
      { first, last } = range(),
      name = format.value.toUpperCase();
    const frames = `frames ${first} to ${last}`;
    const [picture_note, mesh_note] = all_frames()
      ? [`PNG of ${frames}, ${w} × ${h}, in a ZIP`, `${name} of ${frames}, surface and particles, in a ZIP`]
      : [`PNG, frame ${playhead.frame}, ${w} × ${h}`, `${name}, the torn surface in metres`];
    set_text(find("#export-picture-note"), picture_note);
    set_text(find("#export-mesh-note"), mesh_note);
  };
  pop.addEventListener("toggle", say_what);
  session.on("state", () => {
    if (pop.matches(":popover-open")) say_what();
  });
  for (const choice of [format, ...find_all("[name=export-range]")])
    choice.addEventListener("change", say_what);
  const choose = (id, one, all = null) =>
    find(id).addEventListener("click", () => {
      if (all && all_frames()) return all();
      pop.hidePopover?.();
      one();
    });
  choose("#export-picture", save_picture, () => save_all("png"));
  choose("#export-mesh", save_mesh, () => save_all(format.value));
  choose("#export-table", save_table);
  find("#save-button").addEventListener("click", save_picture);
}
