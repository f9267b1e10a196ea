// Notices of the browser's own, outside the page: to those alone who have asked for them.

/** Android's browsers know the permission, but show nothing that a page asks for; by plain http nobody does. */
const canShow = () => isSecureContext && "Notification" in window && !/Android/.test(navigator.userAgent);

/**
 * A button that asks for the permission; it is there while there is something to ask.
 * @param {HTMLButtonElement} button
 * @param {HTMLElement} told says that it is granted
 */
export function connectAsking(button, told) {
  const show = () => {
    button.hidden = !canShow() || Notification.permission !== "default";
    told.hidden = !canShow() || Notification.permission !== "granted";
  };
  button.addEventListener("click", async () => {
    await Notification.requestPermission();
    show();
  });
  show();
}

/** Show a notice that brings the page to the front. @returns {{close: () => void}|null} null: not allowed, or the page is looked at */
export function notify(title, body) {
  if (!canShow() || Notification.permission !== "granted" || document.hasFocus()) return null;
  const note = new Notification(title, { body, tag: "laserbot-offer", requireInteraction: true });
  note.addEventListener("click", () => {
    window.focus();
    note.close();
  });
  return note;
}
