// The first steps on the stage: shown while the robot obeys, once in a browser.

import { setText } from "../common/dom.js";
import { t } from "../common/words.js";
import { FirstSteps, hintText } from "./first_steps.js";

const coarse = matchMedia("(pointer: coarse)");

export class Guide {
  #box;
  #preferences;
  #robot;
  #getView;
  #steps = new FirstSteps();
  #mayDrive = false;
  #pads = 0;

  /**
   * @param {object} wiring
   * @param {HTMLElement} wiring.box with .guide-count, .guide-text, .guide-sight and a button; see templates/home.html
   * @param {import("../common/preferences_store.js").Preferences} wiring.preferences
   * @param {number} wiring.robot the player's
   * @param {() => "camera"|"arena"|"none"} wiring.getView what the stage shows now
   */
  constructor({ box, preferences, robot, getView }) {
    this.#box = box;
    this.#preferences = preferences;
    this.#robot = robot;
    this.#getView = getView;
    box.querySelector("button").addEventListener("click", () => {
      this.#steps.skip();
      this.show();
    });
    preferences.watch((name) => {
      if (name === "guide" && preferences.get("guide")) this.#steps = new FirstSteps();
      this.show();
    });
    document.addEventListener("pointerdown", () => this.show()); // after it, the page may be one for thumbs
  }

  /** A new state of the battle has arrived. @param {boolean} mayDrive whether the player's commands count in it */
  take(previous, current, name, mayDrive) {
    this.#steps.take(previous, current, name);
    this.#mayDrive = mayDrive;
    this.show();
  }

  /** These actions are held. @param {Set<string>} actions */
  act(actions) {
    if (actions.size === 0 || this.#box.hidden) return;
    this.#steps.act(actions);
    this.show();
  }

  /** So many gamepads are there now. @param {number} pads */
  countPads(pads) {
    this.#pads = pads;
    this.show();
  }

  show() {
    if (this.#steps.isDone && this.#preferences.get("guide")) {
      this.#preferences.set("guide", false); // comes back here
      return;
    }
    const hint = this.#mayDrive && this.#preferences.get("guide") ? this.#steps.hint : null;
    if (!hint && this.#box.contains(document.activeElement)) document.activeElement.blur(); // it would keep the keys to itself
    this.#box.hidden = hint === null;
    if (!hint) return;
    const { text, sight } = hintText(hint.step, this.#device, this.#getView(), this.#robot);
    const set = (selector, words) => setText(this.#box.querySelector(selector), words);
    set(".guide-count", t("guide.count", { n: hint.n, all: hint.all }));
    set(".guide-text", text);
    set(".guide-sight", sight);
  }

  get #device() {
    if (this.#pads > 0) return "gamepad";
    const isTouched = coarse.matches || document.body.classList.contains("touch");
    return isTouched ? this.#preferences.get("touch") : "keys";
  }
}
