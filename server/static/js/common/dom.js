// Making elements. Text becomes text nodes: a player's name can never become HTML.

const SVG = "http://www.w3.org/2000/svg";

/**
 * @param {string} tag
 * @param {object} properties set on the element
 * @param {...(Node|string|false|undefined)} children false, undefined and "" are left out
 */
export function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children.filter(Boolean));
  return made;
}

/** A symbol of the sprite in templates/icons.svg, for eyes only. */
export function icon(name) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("class", "icon");
  svg.setAttribute("aria-hidden", "true");
  const use = document.createElementNS(SVG, "use");
  use.setAttribute("href", `#icon-${name}`);
  svg.append(use);
  return svg;
}

/** Set a text only when it differs: screen readers and selections are left alone. */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** A life bar, full; `label` for screen readers. */
export function lifeBar(label) {
  const bar = element("div", { className: "bar", role: "progressbar", ariaLabel: label }, element("div", { className: "bar-fill" }));
  bar.setAttribute("aria-valuemin", "0");
  bar.setAttribute("aria-valuemax", "100");
  return bar;
}

/** Show another picture only when it is another one. */
export function setPicture(image, url) {
  if (image.getAttribute("src") !== url) image.src = url;
}

/** A life bar's width, colour and value for screen readers. */
export function setLife(bar, life) {
  bar.setAttribute("aria-valuenow", String(life));
  bar.dataset.level = life > 50 ? "high" : life > 20 ? "middle" : "low";
  bar.firstElementChild.style.width = `${life}%`;
}
