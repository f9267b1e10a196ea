// Gamepads as sources of the driver's actions: what their sticks and buttons mean, and looking at them while there are any.

import { padActions } from "./keys.js";

/** Buttons of the "standard" mapping (W3C Gamepad, 6): what they do while held, and what they do once when pressed. */
const HELD = { 0: "shoot", 7: "shoot", 12: "up", 13: "down", 14: "left", 15: "right" };
const PRESSED = { 8: "mute", 9: "ready" };
const FIRST_BUTTON = 0; // all that is known of a gamepad without that mapping

const HALF = 0.5; // of a trigger's way: some do not quite come back to 0

/**
 * What a gamepad says.
 * @param {{mapping: string, axes: number[], buttons: {pressed: boolean, value: number}[]}} pad a Gamepad
 * @returns {{held: string[], pressed: string[]}} actions for the driver; of the page ("ready", "mute")
 */
export function padState({ mapping, axes, buttons }) {
  const isKnown = (index) => mapping === "standard" || Number(index) === FIRST_BUTTON;
  const isDown = ([index]) => isKnown(index) && (buttons[index]?.pressed || buttons[index]?.value > HALF);
  const chosen = (table) => Object.entries(table).filter(isDown).map(([, action]) => action);
  const stick = padActions(axes[0] ?? 0, axes[1] ?? 0);
  return { held: [...new Set([...stick, ...chosen(HELD)])], pressed: chosen(PRESSED) };
}

/** All gamepads of this computer, each a source of its own. They are looked at once a picture, and only while there are any. */
export class Gamepads {
  #driver;
  #getPads;
  #nextFrame;
  #isOurs;
  #onChange;
  #onPress;
  #onCount;
  #pressed = new Map(); // index of a pad -> what of the page is pressed on it
  #looking = false;

  /**
   * @param {object} wiring
   * @param {import("./driver.js").Driver} wiring.driver
   * @param {() => (Gamepad|null)[]} wiring.getPads
   * @param {(look: () => void) => void} wiring.nextFrame
   * @param {() => boolean} wiring.isOurs whether what is held is meant for the robot: not for another window or a dialog
   * @param {() => void} wiring.onChange what is held may have changed
   * @param {(action: "ready"|"mute") => void} wiring.onPress
   * @param {(count: number) => void} wiring.onCount so many gamepads are there now
   */
  constructor({ driver, getPads, nextFrame, isOurs, onChange, onPress, onCount }) {
    this.#driver = driver;
    this.#getPads = getPads;
    this.#nextFrame = nextFrame;
    this.#isOurs = isOurs;
    this.#onChange = onChange;
    this.#onPress = onPress;
    this.#onCount = onCount;
  }

  /** A gamepad has come or gone; also to be called once at the beginning. */
  update() {
    const there = new Set(this.#pads().map((pad) => pad.index));
    for (const index of this.#pressed.keys()) {
      if (!there.has(index)) this.#forget(index);
    }
    for (const index of there) {
      if (!this.#pressed.has(index)) this.#pressed.set(index, []);
    }
    this.#onCount(there.size);
    if (!this.#looking && there.size > 0) this.#look();
  }

  #pads() {
    return this.#getPads().filter((pad) => pad?.connected);
  }

  #look() {
    const pads = this.#pads();
    this.#looking = pads.length > 0;
    if (!this.#looking) return;
    const before = [...this.#driver.actions].join();
    for (const pad of pads) this.#take(pad);
    if ([...this.#driver.actions].join() !== before) this.#onChange();
    this.#nextFrame(() => this.#look());
  }

  #take(pad) {
    const source = `gamepad ${pad.index}`;
    const { held, pressed } = this.#isOurs() ? padState(pad) : { held: [], pressed: [] };
    if (held.length > 0) this.#driver.hold(source, held);
    else this.#driver.release(source);
    const before = this.#pressed.get(pad.index) ?? [];
    this.#pressed.set(pad.index, pressed);
    for (const action of pressed) {
      if (!before.includes(action)) this.#onPress(action);
    }
  }

  #forget(index) {
    this.#pressed.delete(index);
    this.#driver.release(`gamepad ${index}`);
    this.#onChange();
  }
}
