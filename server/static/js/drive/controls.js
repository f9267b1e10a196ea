// The keyboard as the driver's source of actions, and when all is let go.

import * as dialogs from "../common/dialogs.js";
import { actionOf } from "./keys.js";

/** Everything is let go when the page does not hear of releases any more; a finger on the screen makes it a touch page. */
export function connectLetGo(driver, onChange) {
  const letGo = () => {
    driver.releaseAll();
    onChange();
  };
  addEventListener("blur", letGo);
  addEventListener("pagehide", letGo);
  document.addEventListener("visibilitychange", () => document.hidden && letGo());
  document.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "touch") document.body.classList.add("touch");
  });
}

/** Whether a key press is meant for the page and not for the robot. */
export function isForPage(event) {
  const typing = event.target instanceof Element && event.target.closest("input, textarea, select, [contenteditable]");
  return dialogs.isOpen() || Boolean(typing) || event.ctrlKey || event.altKey || event.metaKey;
}

/** Keys that reach `target`, which is the window or has the focus. */
export function connectKeyboard(target, driver, onChange) {
  const source = (event) => `key ${event.code || event.key}`;
  let byTab = false; // how the focus has come to where it is; who clicks a button goes on shooting
  const presses = (event) =>
    byTab && actionOf(event) === "shoot" && event.target instanceof Element && event.target.closest("button, a") !== null;
  target.addEventListener("pointerdown", () => (byTab = false), true);
  target.addEventListener("keydown", (event) => {
    const action = actionOf(event);
    byTab ||= event.key === "Tab";
    if (!driver.driving || presses(event)) return;
    if (isForPage(event)) {
      driver.releaseAll(); // a shortcut or a dialog may swallow the releases
      onChange();
    } else if (action) {
      event.preventDefault(); // no scrolling, no pressing of a focused button
      driver.hold(source(event), [action]);
      onChange();
    }
  });
  target.addEventListener("keyup", (event) => {
    // a button is pressed by Space's release
    if (driver.driving && actionOf(event) && !dialogs.isOpen() && !presses(event)) event.preventDefault();
    driver.release(source(event));
    onChange();
  });
}
