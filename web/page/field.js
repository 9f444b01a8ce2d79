// One parameter on the page: slider with default tick, typed value with unit, reset; or a list of choices.
import { find, icon, make, set_text } from "./element.js";
import {
  clamp,
  format_number,
  parse_typed,
  position_of,
  round_ticks,
  shown_unit,
  value_at,
} from "./quantity.js";

const STEPS = 1000;
const KEYS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 };
const WHEN = { reset: "after reset" };
const at_thumb = (t) => `calc(${t} * (100% - var(--thumb)) + var(--thumb) / 2)`;

/// `tried(value)` while a slider moves, `settled(value, before)` once at the end of a change.
export class Field {
  #held = false;
  #before;
  #moved = false;

  constructor(parameter, { tried, settled }) {
    this.parameter = parameter;
    this.value = parameter.value;
    this.unit = shown_unit(parameter);
    this.tried = tried;
    this.settled = settled;
    this.key = `param-${parameter.id.replace(/\W+/g, "-")}`;
    this.node = parameter.choices ? this.#choice() : this.#slider();
    this.#draw();
  }

  text_of(value) {
    if (this.parameter.choices) return String(value);
    return format_number(value / this.unit.factor, this.parameter.step ? 6 : 3);
  }

  with_unit(value) {
    return this.unit.text ? `${this.text_of(value)} ${this.unit.text}` : this.text_of(value);
  }

  /// The server's value; a control that is held keeps its own.
  accept(value) {
    if (this.#held) return;
    this.value = value;
    this.#draw();
  }

  /// A change that is complete at once: a typed value, a default, an undo.
  set(value) {
    const before = this.value;
    this.#complain("");
    this.value = value;
    this.#draw(true);
    if (value !== before) this.settled(value, before);
  }

  #note() {
    const words = this.parameter.hero ? "" : WHEN[this.parameter.applies];
    return words ? make("small", {}, words) : null;
  }

  #reset_button() {
    const { label, default: standard } = this.parameter;
    const text = this.with_unit(standard);
    const button = make("button", {
      class: "button default",
      "aria-label": `Reset ${label} to ${text}`,
      title: `Back to ${text}`,
      on_click: () => this.set(standard),
    });
    button.append(icon("reset"));
    return button;
  }

  #choice() {
    const { label, choices, help } = this.parameter;
    const select = make(
      "select",
      { id: this.key, on_change: () => this.set(this.#chosen(select)) },
      ...choices.map((choice) =>
        make("option", { value: choice }, String(choice).replaceAll("_", " ")),
      ),
    );
    return make(
      "div",
      { class: "param choice", title: help },
      make("label", { for: this.key }, label, this.#note()),
      this.#reset_button(),
      select,
    );
  }

  #chosen(select) {
    return this.parameter.choices.find((choice) => String(choice) === select.value);
  }

  #slider() {
    const { label, help, hero, default: standard } = this.parameter;
    const slider = make("input", {
      class: "slider",
      type: "range",
      min: 0,
      max: STEPS,
      "aria-label": label,
      on_pointerdown: () => {
        this.#held = true;
        this.#before = this.value;
        this.#moved = false;
      },
      on_pointermove: (event) => {
        if (event.buttons) this.#moved = true;
      },
      on_input: () => this.#slide(value_at(this.parameter, slider.value / STEPS)),
      on_change: () => this.#let_go(),
      on_blur: () => this.#let_go(),
      on_pointerup: () => setTimeout(() => this.#let_go()),
      on_pointercancel: () => this.#let_go(),
      on_dblclick: () => {
        if (!this.#moved) this.set(standard);
      },
      on_keydown: (event) => this.#key(event),
    });
    const number = make("input", {
      id: this.key,
      inputmode: "decimal",
      autocomplete: "off",
      spellcheck: "false",
      "aria-describedby": `${this.key}-unit`,
      on_change: () => this.#type(number.value),
      on_focus: () => number.select(),
      on_keydown: (event) => {
        if (event.key === "Escape") {
          this.#draw(true);
          number.blur();
        }
      },
    });
    return make(
      "div",
      { class: hero ? "param hero" : "param", title: hero ? null : help },
      make("label", { for: this.key }, label, this.#note()),
      this.#reset_button(),
      make(
        "div",
        { class: "number" },
        number,
        make("span", { id: `${this.key}-unit` }, this.unit.text),
      ),
      hero && help ? make("small", { class: "about" }, help) : null,
      make(
        "div",
        { class: "slide" },
        make("i", { class: "tick", "--at": at_thumb(position_of(this.parameter, standard)) }),
        slider,
      ),
      hero ? this.#ticks() : null,
      make("p", { class: "message", role: "status", hidden: true }),
    );
  }

  #ticks() {
    const marks = round_ticks(this.parameter, this.unit.factor).map((tick) =>
      make(
        "span",
        {
          "--at": `${position_of(this.parameter, tick * this.unit.factor) * 100}%`,
        },
        format_number(tick),
      ),
    );
    return make("div", { class: "ticks", "aria-hidden": "true" }, ...marks);
  }

  #slide(value) {
    if (this.#before === undefined) this.#before = this.value;
    this.#held = true;
    this.#complain("");
    this.value = value;
    this.#draw();
    this.tried(value);
  }

  #let_go() {
    this.#held = false;
    const before = this.#before;
    this.#before = undefined;
    if (before !== undefined && before !== this.value) this.settled(this.value, before);
  }

  #key(event) {
    const { min, max, step } = this.parameter;
    const ends = { Home: min, End: max };
    let value = ends[event.key];
    const way = KEYS[event.key];
    if (way && step)
      value = clamp(this.value + step * Math.sign(way) * (Math.abs(way) > 1 ? 5 : 1), min, max);
    else if (way) value = this.#nudged(way * (event.shiftKey ? 0.002 : 0.01));
    if (value === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.set(value);
  }

  // Three digits can round a small step away, so it grows until the value moves.
  #nudged(share) {
    const from = position_of(this.parameter, this.value);
    for (let k = 1; k <= 10; k++) {
      const value = value_at(this.parameter, from + k * share);
      if (value !== this.value) return value;
    }
    return this.value;
  }

  #type(text) {
    const { label, min, max, step } = this.parameter;
    let value = parse_typed(text, this.unit);
    if (Number.isFinite(value) && step) value = min + Math.round((value - min) / step) * step;
    if (value >= min * (1 - 1e-9) && value <= max * (1 + 1e-9))
      return this.set(clamp(value, min, max));
    this.#draw(true);
    this.#complain(
      `${label} goes from ${this.text_of(min)} to ${this.with_unit(max)}; ${this.with_unit(this.value)} is kept.`,
    );
  }

  #complain(text) {
    const message = find(".message", this.node);
    if (!message) return;
    message.hidden = !text;
    set_text(message, text);
  }

  #draw(even_focused = false) {
    const { default: standard } = this.parameter;
    this.node.classList.toggle("changed", this.text_of(this.value) !== this.text_of(standard));
    if (this.parameter.choices) {
      find("select", this.node).value = this.value;
      return;
    }
    const slider = find(".slider", this.node),
      number = find(".number input", this.node);
    const position = position_of(this.parameter, this.value);
    slider.value = Math.round(position * STEPS);
    slider.style.setProperty("--at", at_thumb(position));
    slider.setAttribute("aria-valuetext", this.with_unit(this.value));
    if (even_focused || document.activeElement !== number) number.value = this.text_of(this.value);
  }
}
