// Questions and messages in a <dialog>, one at a time. All text is set as text, never as HTML.

import { element, icon } from "./dom.js";
import { t } from "./words.js";

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
 * @param {"info"|"success"|"warning"|"error"|null} [content.kind] the symbol; null for none
 * @param {string} [content.look] more classes
 * @param {string} content.title
 * @param {string} [content.text]
 * @param {Node[]} [content.body] more than text
 * @param {string|null} [content.ok] the button's text; null for no button
 * @param {string} [content.cancel] text of a second button
 * @param {{value: string, text: string}[]} [content.others] more buttons
 * @param {boolean} [content.calm] keep the focus off the buttons: a player may still be hammering the keys
 * @returns {Promise<string>} "ok", the value of another button, or "" for cancel and Escape
 */
export function show({ kind = "info", look = "", title, text = "", body = [], ok = t("common.ok"), cancel, others = [], calm = false }) {
  closeAll();
  const heading = element("h2", { id: "dialog-title", tabIndex: -1 }, title);
  const buttons = [];
  if (cancel) buttons.push(element("button", { className: "button quiet", value: "" }, cancel));
  for (const { value, text: label } of others) buttons.push(element("button", { className: "button quiet", value }, label));
  if (ok) buttons.push(element("button", { className: "button", value: "ok", autofocus: !calm }, ok));
  const dialog = element(
    "dialog",
    { className: `dialog ${kind ?? ""} ${look}` },
    element(
      "form",
      { method: "dialog" },
      kind && icon(kind),
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
      resolve(dialog.returnValue);
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
