// Folding panels and tabs; the choice is remembered.
import { find, find_all } from "./element.js";

export function watch_panels() {
  const gallery = find("#gallery-button");
  const fold = (slim) => {
    document.body.classList.toggle("slim", slim);
    gallery.setAttribute("aria-expanded", String(!slim));
    gallery.title = slim ? "Show the names (G)" : "Fold to thumbnails (G)";
  };
  const narrow = matchMedia("(min-width: 900px) and (max-width: 1199px)");
  const fold_by_width = () =>
    fold(
      localStorage.getItem("gallery") === "slim" ||
        (narrow.matches && localStorage.getItem("gallery") !== "wide"),
    );
  fold_by_width();
  narrow.addEventListener("change", fold_by_width);
  gallery.addEventListener("click", () => {
    const slim = !document.body.classList.contains("slim");
    localStorage.setItem("gallery", slim ? "slim" : "wide");
    fold(slim);
  });

  const tabs = find_all(".tabs button");
  const choose = (name) => {
    document.body.dataset.tab = name;
    for (const tab of tabs) tab.setAttribute("aria-expanded", String(tab.dataset.tab === name));
  };
  for (const tab of tabs) tab.addEventListener("click", () => choose(tab.dataset.tab));

  find("#help-button").addEventListener("click", () => find("#help").showModal());
  return { hide_panels: () => document.body.classList.toggle("bare") };
}
