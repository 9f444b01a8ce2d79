// Keys of the page, and the rule that Space belongs to a button only when Tab led there.
import { find } from "./element.js";

const BUTTONS = {
  r: "#reset-button",
  l: "#loop-button",
  f: "#fit-button",
  p: "#save-button",
  g: "#gallery-button",
  "?": "#help-button",
};

export function watch_keys(playhead, { undo, hide_panels, tools }) {
  const switch_box = find("#single-keys");
  switch_box.checked = localStorage.getItem("single-keys") !== "off";
  switch_box.addEventListener("change", () =>
    localStorage.setItem("single-keys", switch_box.checked ? "on" : "off"),
  );

  // :focus-visible cannot tell: the key press itself turns it on.
  let led_by_tab = false,
    swallow_space = false;
  addEventListener(
    "pointerdown",
    () => {
      led_by_tab = false;
    },
    true,
  );
  addEventListener(
    "keyup",
    (event) => {
      if (event.key === " " && swallow_space) event.preventDefault();
      swallow_space = false;
    },
    true,
  );

  const change_speed = (way) => {
    const list = find("#speed");
    list.selectedIndex = Math.max(0, Math.min(list.length - 1, list.selectedIndex + way));
    playhead.set_speed(Number(list.value));
  };

  addEventListener("keydown", (event) => {
    if (event.key === "Tab") led_by_tab = true;
    if (find("#help").open || event.altKey || event.metaKey) return;
    const focused = document.activeElement ?? document.body;
    const typing = focused.matches(
      "input:not([type=range]):not([type=radio]):not([type=checkbox]), select, textarea",
    );
    if (typing) return;
    if (event.ctrlKey) {
      if (event.key.toLowerCase() !== "z" || event.shiftKey) return;
      event.preventDefault();
      return undo();
    }
    if (event.key === " ") {
      if (led_by_tab && focused.matches("button, summary, [type=radio], [type=checkbox]")) return;
      event.preventDefault();
      swallow_space = true;
      if (!event.repeat) playhead.toggle();
      return;
    }
    const own_keys = focused.matches("[type=range]:not(#scrub), [type=radio]");
    if (own_keys && /^(Arrow|Home|End|Page)/.test(event.key)) return;
    if (event.key.length === 1 && !switch_box.checked) return;
    if (!act(event)) return;
    event.preventDefault();
  });

  function act({ key, shiftKey }) {
    const far = shiftKey ? 10 : 1;
    const lower = key.length === 1 ? key.toLowerCase() : key;
    if (BUTTONS[lower]) find(BUTTONS[lower]).click();
    else if (key === "ArrowLeft") playhead.move(-far);
    else if (key === "ArrowRight") playhead.move(far);
    else if (key === "Home") playhead.seek(0);
    else if (key === "End") playhead.to_newest();
    else if (lower === "h") hide_panels();
    else if (/^[1-9]$/.test(key)) tools.choose_nth(Number(key) - 1);
    else if (key === "[") tools.widen(1 / 1.2);
    else if (key === "]") tools.widen(1.2);
    else if (key === "-") change_speed(-1);
    else if (key === "+" || key === "=") change_speed(1);
    else return false;
    return true;
  }
}
