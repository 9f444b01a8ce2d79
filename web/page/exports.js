// Downloads: the picture, the mesh of a frame, the table of the run.
import { find, make, set_text } from "./element.js";

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
  const save_picture = () => {
    const query = new URLSearchParams({ ...picture.view_query(size()), quality: "still" });
    download(`/api/frames/${playhead.frame}.png?${query}`, `${stem()}.png`);
    toast(`Saving ${stem()}.png`);
  };
  const format = find("#export-format");
  format.addEventListener("change", () =>
    set_text(
      find("#export-mesh-note"),
      `${format.value.toUpperCase()}, the torn surface in metres`,
    ),
  );
  const save_mesh = () => {
    const ending = format.value;
    download(`/api/frames/${playhead.frame}/mesh.${ending}`, `${stem()}.${ending}`);
    toast(`Saving ${stem()}.${ending}`);
  };
  const save_table = () => {
    const url = URL.createObjectURL(new Blob([series.csv()], { type: "text/csv" }));
    download(url, `${session.state?.scene ?? "rend"}.csv`);
    setTimeout(() => URL.revokeObjectURL(url), 10000);
    toast(`Saved ${series.frames.length} rows`);
  };
  const pop = find("#export");
  pop.addEventListener("toggle", () => {
    const { w, h } = size();
    set_text(find("#export-picture-note"), `PNG, frame ${playhead.frame}, ${w} × ${h}`);
  });
  const choose = (id, action) =>
    find(id).addEventListener("click", () => {
      pop.hidePopover?.();
      action();
    });
  choose("#export-picture", save_picture);
  choose("#export-mesh", save_mesh);
  choose("#export-table", save_table);
  find("#save-button").addEventListener("click", save_picture);
}
