// Rows that stay while their contents change: focus, selection and a finger on a button outlive a redraw.

import { element, icon, setText } from "../common/dom.js";

/**
 * Show `items` as the rows of a table's body or of a list.
 * @template Item
 * @param {HTMLElement} body a further element right behind its table or list, `[data-empty]`, is shown when there are none
 * @param {Item[]} items
 * @param {object} way
 * @param {(item: Item) => string} way.key the same for the same thing
 * @param {(item: Item) => HTMLElement} way.make
 * @param {(row: HTMLElement, item: Item) => void} [way.fill]
 */
export function showRows(body, items, { key, make, fill }) {
  const focused = body.contains(document.activeElement) ? document.activeElement : null;
  const rows = new Map([...body.children].map((row) => [row.dataset.key, row]));
  const wanted = items.map((item) => {
    const row = rows.get(key(item)) ?? make(item);
    row.dataset.key = key(item);
    fill?.(row, item);
    return row;
  });
  if (wanted.length !== body.children.length || wanted.some((row, index) => body.children[index] !== row)) {
    body.replaceChildren(...wanted);
  }
  // a row that has moved has lost the focus; that of one that has gone passes on to the section's heading
  if (focused && document.activeElement !== focused) {
    (focused.isConnected ? focused : body.closest("section").querySelector("h2")).focus();
  }
  const box = body.closest("table") ?? body;
  box.hidden = items.length === 0;
  box.parentElement.querySelector("[data-empty]").hidden = items.length > 0;
}

/**
 * A row of a table. On a narrow screen it becomes a card, on which each cell is named; the roles keep it a row for screen
 * readers there.
 * @param {[string, string][]} columns name of the cell's field, and its title
 * @param {(Node|false)[]} buttons
 */
export function tableRow(columns, buttons) {
  const cells = columns.map(([field, title], index) => {
    const cell = element(index === 0 ? "th" : "td");
    cell.setAttribute("role", index === 0 ? "rowheader" : "cell");
    cell.dataset.field = field;
    cell.dataset.title = title;
    return cell;
  });
  const last = element("td", { className: "row-buttons" }, ...buttons);
  last.setAttribute("role", "cell");
  const row = element("tr", {}, ...cells, last);
  row.setAttribute("role", "row");
  return row;
}

/** Set a cell of a row to a text, or to a text with a level ("bad": needs a hand). */
export function setCell(row, field, value) {
  const { text, level = "" } = typeof value === "string" ? { text: value } : value;
  const cell = row.querySelector(`[data-field="${field}"]`);
  setText(cell, text);
  cell.dataset.level = level;
}

/** A button of a row; `about` says for screen readers to whom it belongs. */
export function rowButton(text, about, onClick, className = "quiet") {
  const button = element("button", { type: "button", className: `button ${className}`, onclick: onClick });
  button.append(element("span", {}, text), element("span", { className: "visually-hidden" }, ` ${about}`));
  return button;
}

/** The same with a picture, beside which a compact row has no room for the text: that is its tooltip then. */
export function iconButton(picture, text, about, onClick) {
  const button = rowButton(text, about, onClick);
  button.classList.add("with-icon");
  button.prepend(icon(picture));
  setButton(button, text);
  return button;
}

/** Give a row's button another text. */
export function setButton(button, text) {
  setText(button.querySelector("span"), text);
  button.title = text;
}
