// Finds and builds document nodes without markup strings.

export const find = (selector, root = document) => root.querySelector(selector);
export const find_all = (selector, root = document) => [...root.querySelectorAll(selector)];

const SVG = "http://www.w3.org/2000/svg";

/// An <svg> that shows one symbol of the page's sprite.
export function icon(name) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const use = document.createElementNS(SVG, "use");
  use.setAttribute("href", `#i-${name}`);
  svg.append(use);
  return svg;
}

/// A node with attributes; `on_*` keys are listeners, `--*` keys are CSS variables, null ones are left out.
export function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (key.startsWith("on_")) node.addEventListener(key.slice(3), value);
    else if (key.startsWith("--")) node.style.setProperty(key, value);
    else node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/// Puts the icons named by `data-icon` into the page.
export function fill_icons(root = document) {
  for (const node of find_all("[data-icon]", root)) node.prepend(icon(node.dataset.icon));
}

/// Shows another icon in a button.
export function set_icon(node, name) {
  node.querySelector("use").setAttribute("href", `#i-${name}`);
}

/// Writes text only when it differs, so that live regions speak once.
export function set_text(node, text) {
  if (node.textContent !== text) node.textContent = text;
}
