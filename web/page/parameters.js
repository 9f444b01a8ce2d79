// The parameter panel: whatever the server reports, in groups, with undo.
import { find, make, set_text } from "./element.js";
import { get_json } from "./api.js";
import { Field } from "./field.js";
import { PatchQueue } from "./patch_queue.js";

const NOTES = { postprocess: "also on recorded frames", reset: "after reset" };
/// Groups that start folded: few people need them.
const FOLDED = new Set(["Solver"]);

export class ParameterPanel {
  #fields = new Map();
  #undo = [];
  #queue;
  #toast;
  #loading = false;

  constructor(session, toast) {
    this.#toast = toast;
    this.#queue = new PatchQueue(
      (error, ids) => this.#refuse(error, ids),
      () => {},
    );
    let known;
    session.on("scene", () => {
      this.#undo = [];
      this.#show_undo();
      this.load(true);
    });
    session.on("found", () => this.load());
    session.on("state", (state) => {
      const seen = `${state.parameters_revision} ${state.status === "preparing"}`;
      if (known !== undefined && known !== seen) this.load();
      known = seen;
    });
    find("#undo-button").addEventListener("click", () => this.undo());
  }

  value_of(id) {
    return this.#fields.get(id)?.value;
  }
  has(id) {
    return this.#fields.has(id);
  }
  set(id, value) {
    this.#fields.get(id)?.set(value);
  }

  /// {id: value} of those that are not at their default.
  changed() {
    return Object.fromEntries(
      [...this.#fields]
        .filter(([, field]) => field.value !== field.parameter.default)
        .map(([id, field]) => [id, field.value]),
    );
  }

  async load(rebuild = false) {
    if (this.#loading && !rebuild) return;
    this.#loading = true;
    try {
      const { parameters } = await get_json("/api/parameters");
      const same =
        parameters.length === this.#fields.size &&
        parameters.every((parameter) => this.#same_kind(parameter));
      if (rebuild || !same) this.#build(parameters);
      else for (const parameter of parameters) this.#accept(parameter);
    } catch (error) {
      if (error.status) this.#toast(error.message);
    } finally {
      this.#loading = false;
    }
  }

  undo() {
    const last = this.#undo.pop();
    if (last) last();
    this.#show_undo();
  }

  /// Other panels put their own changes on the same stack.
  remember(revert) {
    this.#undo.push(revert);
    if (this.#undo.length > 100) this.#undo.shift();
    this.#show_undo();
  }

  #same_kind(parameter) {
    const known = this.#fields.get(parameter.id)?.parameter;
    return (
      known &&
      ["min", "max", "default", "scale", "label", "unit", "group"].every(
        (key) => known[key] === parameter[key],
      )
    );
  }

  #accept({ id, value }) {
    if (!this.#queue.holds(id)) this.#fields.get(id).accept(value);
  }

  #build(parameters) {
    this.#fields.clear();
    const panel = find("#panel-material"),
      view = find("#group-view");
    for (const old of panel.querySelectorAll(".group:not(#group-material), .param")) old.remove();
    view.replaceChildren();
    const names = [...new Set(parameters.map(({ group }) => group))];
    const first = names.find((name) => name.startsWith("Material")) ?? "Material";
    set_text(find("#material-title"), first);
    for (const name of names) {
      const members = parameters
        .filter(({ group }) => group === name)
        .sort((a, b) => Number(b.hero ?? false) - Number(a.hero ?? false));
      const place =
        name === first
          ? find("#group-material")
          : name === "View"
            ? view
            : this.#group(name, members);
      if (!place.isConnected) panel.append(place);
      for (const parameter of members) place.append(this.#field(parameter, members).node);
    }
  }

  #group(name, members) {
    const note = this.#common_note(members);
    const words = [make("h2", {}, name), note ? make("span", { class: "group-note" }, note) : null];
    if (!FOLDED.has(name))
      return make("div", { class: "group" }, make("div", { class: "head" }, ...words));
    return make("details", { class: "group" }, make("summary", { class: "head" }, ...words));
  }

  #common_note(members) {
    const kinds = new Set(members.map(({ applies }) => applies));
    return kinds.size === 1 ? NOTES[[...kinds][0]] : undefined;
  }

  #field(parameter, members) {
    const noted_above = parameter.group !== "Material" && this.#common_note(members);
    const shown = noted_above ? { ...parameter, applies: "live" } : parameter;
    const field = new Field(shown, {
      tried: (value) => this.#queue.put(parameter.id, value),
      settled: (value, before) => {
        this.#queue.put(parameter.id, value);
        this.remember(() => {
          field.accept(before);
          this.#queue.put(parameter.id, before);
        });
      },
    });
    this.#fields.set(parameter.id, field);
    return field;
  }

  #refuse(error, ids) {
    if (error.status === 422) this.#toast(error.message);
    else if (!error.status) this.#toast("The change did not reach the server.");
    if (ids.length) this.load();
  }

  #show_undo() {
    find("#undo-button").disabled = !this.#undo.length;
  }
}
