// Questions and messages in a <dialog>, one at a time. All text is set as text, never as HTML.

import { element, icon } from "./dom.js";

/** Whether a dialog is open: game keys then belong to it. */
export function isOpen() {
  return document.querySelector("dialog[open]") !== null;
}

/** Take away whatever is open, as if it had been cancelled. */
export function closeAll() {
  for (const dialog of document.querySelectorAll("dialog[open]")) dialog.close();
}

/**
 * Show a dialog in place of any other.
 * @param {object} content
 * @param {"info"|"success"|"warning"|"error"} [content.kind]
 * @param {string} content.title
 * @param {string} [content.text]
 * @param {Node[]} [content.body] more than text
 * @param {string|null} [content.ok] the button's text; null for no button
 * @param {string} [content.cancel] text of a second button
 * @param {boolean} [content.calm] keep the focus off the buttons: a player may still be hammering the keys
 * @returns {Promise<boolean>} true for ok, false for cancel or Escape
 */
export function show({ kind = "info", title, text = "", body = [], ok = "OK", cancel, calm = false }) {
  closeAll();
  const heading = element("h2", { id: "dialog-title", tabIndex: -1 }, title);
  const buttons = [];
  if (cancel) buttons.push(element("button", { className: "button quiet", value: "" }, cancel));
  if (ok) buttons.push(element("button", { className: "button", value: "ok", autofocus: !calm }, ok));
  const dialog = element(
    "dialog",
    { className: `dialog ${kind}` },
    element(
      "form",
      { method: "dialog" },
      icon(kind),
      heading,
      text && element("p", {}, text),
      ...body,
      buttons.length > 0 && element("div", { className: "buttons" }, ...buttons),
    ),
  );
  dialog.setAttribute("aria-labelledby", heading.id);
  dialog.addEventListener("keydown", (event) => {
    if (event.repeat && (event.key === "Enter" || event.key === " ")) event.preventDefault(); // held since before
  });
  document.body.append(dialog);
  dialog.showModal();
  if (calm || !ok) heading.focus();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "ok");
    });
  });
}

/** A short notice at the edge that goes by itself. */
export function toast(text, ms = 3000) {
  const box = document.getElementById("toasts");
  const note = element("p", { className: "toast" }, text);
  box.append(note);
  setTimeout(() => note.remove(), ms);
}

/** The help of both pages. */
export function help() {
  const caps = (keys) => keys.map((key) => element("kbd", {}, key));
  const row = (keys, meaning) =>
    element("div", { className: "help-row" }, element("span", { className: "help-keys" }, ...caps(keys)), meaning);
  return show({
    title: "How to play",
    body: [
      row(["↑", "←", "↓", "→"], "move the robot"),
      row(["W", "A", "S", "D"], "move the robot"),
      row(["Enter", "Space"], "fire the laser"),
      element("p", {}, "On a touch screen: pad on the left, fire button on the right."),
      element(
        "p",
        {},
        "Press Ready. When two players are ready, a countdown runs; then every hit takes life. The last one alive wins.",
      ),
      element("p", {}, "A shot lasts half a second: wait until the laser's bar is full."),
    ],
  });
}
