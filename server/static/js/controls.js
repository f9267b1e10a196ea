// Keyboard and touch, as the driver's sources of actions.

import * as dialogs from "./dialogs.js";
import { actionOf, padActions } from "./keys.js";

/** Connect the page's controls to `driver`; `onChange` is called after each change of what is held. */
export function connectControls(driver, onChange) {
  connectKeyboard(window, driver, onChange);
  connectPad(document.getElementById("pad"), driver, onChange);
  connectFire(document.getElementById("fire"), driver, onChange);

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
function isForPage(event) {
  const typing = event.target instanceof Element && event.target.closest("input, textarea, select, [contenteditable]");
  return dialogs.isOpen() || Boolean(typing) || event.ctrlKey || event.altKey || event.metaKey;
}

/** Keys that reach `target`, which is the window or has the focus. */
export function connectKeyboard(target, driver, onChange) {
  const source = (event) => `key ${event.code || event.key}`;
  target.addEventListener("keydown", (event) => {
    const action = actionOf(event);
    if (!driver.driving) return;
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
    if (driver.driving && actionOf(event) && !dialogs.isOpen()) event.preventDefault(); // a button is pressed by Space's release
    driver.release(source(event));
    onChange();
  });
}

/** One element for all directions, so that a thumb can slide from one to the next. */
export function connectPad(pad, driver, onChange) {
  const source = (event) => `pad ${event.pointerId}`;
  const hold = (event) => {
    const box = pad.getBoundingClientRect();
    const x = (event.clientX - box.left) / (box.width / 2) - 1;
    const y = (event.clientY - box.top) / (box.height / 2) - 1;
    driver.hold(source(event), padActions(x, y));
    onChange();
  };
  connectPointer(pad, hold, (event) => {
    driver.release(source(event));
    onChange();
  });
  pad.addEventListener("pointermove", (event) => pad.hasPointerCapture(event.pointerId) && hold(event));
}

/** A button that fires while it is held. */
export function connectFire(button, driver, onChange) {
  const source = (event) => `fire ${event.pointerId}`;
  const hold = (event) => {
    driver.hold(source(event), ["shoot"]);
    onChange();
  };
  connectPointer(button, hold, (event) => {
    driver.release(source(event));
    onChange();
  });
}

function connectPointer(target, onDown, onUp) {
  target.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    target.setPointerCapture(event.pointerId); // the release is heard wherever the finger is by then
    onDown(event);
  });
  target.addEventListener("lostpointercapture", onUp); // up and cancel both end with it
  target.addEventListener("contextmenu", (event) => event.preventDefault()); // a long press
}
