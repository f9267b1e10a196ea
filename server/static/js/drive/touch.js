// Thumbs on the screen, as sources of the driver's actions. Each pointer is its own source: thumbs do not disturb each other.

import { padActions } from "./keys.js";

/**
 * Where a floating stick is while a thumb holds it: its centre stays where the thumb came down, and is drawn along by a thumb
 * that goes further than the stick does, so that turning back counts at once. Pure.
 * @param {{x: number, y: number}} centre px
 * @param {{x: number, y: number}} thumb px
 * @param {number} radius px from the centre to the stick's edge
 * @returns {{centre: {x: number, y: number}, knob: {x: number, y: number}, actions: string[]}} `knob` is seen from the centre
 */
export function stickAt(centre, thumb, radius) {
  const x = thumb.x - centre.x;
  const y = thumb.y - centre.y;
  const beyond = Math.max(1, Math.hypot(x, y) / radius);
  const knob = { x: x / beyond, y: y / beyond };
  return {
    centre: { x: thumb.x - knob.x, y: thumb.y - knob.y },
    knob,
    actions: padActions(knob.x / radius, knob.y / radius),
  };
}

/** One element for all directions, so that a thumb can slide from one to the next. */
export function connectPad(pad, driver, onChange) {
  const hold = (event) => {
    const box = pad.getBoundingClientRect();
    const x = (event.clientX - box.left) / (box.width / 2) - 1;
    const y = (event.clientY - box.top) / (box.height / 2) - 1;
    driver.hold(`pad ${event.pointerId}`, padActions(x, y));
    onChange();
  };
  connectPointer(pad, {
    onDown: hold,
    onMove: hold,
    onUp: (event) => {
      driver.release(`pad ${event.pointerId}`);
      onChange();
    },
  });
}

/** A button that fires while it is held. */
export function connectFire(button, driver, onChange) {
  connectPointer(button, {
    onDown: (event) => {
      driver.hold(`fire ${event.pointerId}`, ["shoot"]);
      onChange();
    },
    onUp: (event) => {
      driver.release(`fire ${event.pointerId}`);
      onChange();
    },
  });
}

/**
 * A stick that comes to wherever in `zone` the thumb comes down. One thumb has it; others in the zone wait.
 * @param {HTMLElement} zone
 * @param {HTMLElement} stick in `zone`; its first child is the knob
 */
export function connectStick(zone, stick, driver, onChange) {
  const knob = stick.firstElementChild;
  let holder = null; // the pointer that has the stick
  let centre = null;

  const hold = (event) => {
    if (event.pointerId !== holder) return;
    const box = zone.getBoundingClientRect();
    const thumb = { x: event.clientX - box.left, y: event.clientY - box.top };
    const now = stickAt(centre ?? thumb, thumb, stick.offsetWidth / 2);
    centre = now.centre;
    stick.style.left = `${centre.x}px`;
    stick.style.top = `${centre.y}px`;
    knob.style.translate = `${now.knob.x}px ${now.knob.y}px`;
    driver.hold(`stick ${holder}`, now.actions);
    onChange();
  };
  connectPointer(zone, {
    onDown: (event) => {
      if (holder !== null) return;
      holder = event.pointerId;
      stick.classList.add("is-held");
      hold(event);
    },
    onMove: hold,
    onUp: (event) => {
      if (event.pointerId !== holder) return;
      driver.release(`stick ${holder}`);
      holder = null;
      centre = null;
      stick.classList.remove("is-held");
      stick.style.left = stick.style.top = knob.style.translate = ""; // back to its place
      onChange();
    },
  });
}

function connectPointer(target, { onDown, onMove, onUp }) {
  target.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    target.setPointerCapture(event.pointerId); // the release is heard wherever the finger is by then
    onDown(event);
  });
  if (onMove) target.addEventListener("pointermove", (event) => target.hasPointerCapture(event.pointerId) && onMove(event));
  target.addEventListener("lostpointercapture", onUp); // up and cancel both end with it
  target.addEventListener("contextmenu", (event) => event.preventDefault()); // a long press
}

/**
 * Nothing of the browser's own comes between thumbs and robot while `isDriving()`: no menu by a long press, no zoom by two
 * fingers. Scrolling and selecting end by the style of body.is-driving.
 */
export function connectStillness(page, isDriving) {
  const refuse = (event) => isDriving() && !event.target.closest?.("dialog, [popover]") && event.preventDefault();
  page.addEventListener("contextmenu", refuse);
  page.addEventListener("gesturestart", refuse); // Safari's own, by two fingers
}
