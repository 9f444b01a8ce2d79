// An export of many frames: the server fills an archive, the page shows how far it is and fetches it.
import { find, set_text } from "./element.js";
import { get_json, pause_for, Problem, send_json } from "./api.js";

const POLL_MS = 400,
  LOST_MS = 2000;

function time_left(seconds) {
  if (!(seconds > 0)) return "";
  return seconds < 90 ? `, ${Math.ceil(seconds)} s left` : `, ${Math.round(seconds / 60)} min left`;
}

const size_of = (bytes) => (bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

export class ExportJob {
  #toast;
  #download;
  #id = null;

  /// `download(href, name)` hands a file to the browser.
  constructor(toast, download) {
    this.#toast = toast;
    this.#download = download;
    find("#export-cancel").addEventListener("click", () => this.#cancel());
    this.#adopt();
  }

  /// `order` is {format, first, last}, `view` the query of a picture.
  async start(order, view) {
    try {
      const { id } = await send_json("POST", `/api/exports?${new URLSearchParams(view)}`, order);
      this.#follow(id, (href, name, size) => {
        this.#download(href, name);
        this.#toast(`Saving ${name}, ${size}`);
      });
    } catch (error) {
      this.#toast(error.message);
      if (error.status === 409) this.#adopt();
    }
  }

  // The job that another page, or this one before it was loaded again, has started.
  async #adopt() {
    const { running } = await get_json("/api/exports").catch(() => ({}));
    if (!running || this.#id !== null) return;
    this.#follow(running.id, (href, name, size) =>
      this.#toast(`${name} is ready, ${size}`, { label: "Save", run: () => this.#download(href, name) }),
    );
  }

  async #follow(id, ready) {
    this.#id = id;
    try {
      const { status, name, bytes, reason } = await this.#wait(id);
      if (status === "done") ready(`/api/exports/${id}/file`, `${name}.zip`, size_of(bytes));
      else if (status === "cancelled") this.#toast("The export was cancelled.");
      else this.#toast(`The export failed: ${reason}`);
    } catch (error) {
      this.#toast(error.message);
    }
    this.#id = null;
    find("#export-job").hidden = true;
  }

  async #wait(id) {
    while (true) {
      try {
        const job = await get_json(`/api/exports/${id}`);
        if (job.status !== "running") return job;
        this.#show(job);
        await pause_for(POLL_MS);
      } catch (error) {
        if (error instanceof Problem && error.status < 500) throw error;
        await pause_for(LOST_MS);
      }
    }
  }

  #show({ done, of, seconds_left }) {
    find("#export-job").hidden = false;
    set_text(find("#export-job-text"), `Frame ${done} of ${of}${time_left(seconds_left)}`);
    find("#export-job progress").value = done / of;
  }

  #cancel() {
    send_json("DELETE", `/api/exports/${this.#id}`).catch((error) => this.#toast(error.message));
  }
}
