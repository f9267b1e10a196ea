// Which picture a player's stage shows: that of the own robot's camera ("camera"), or the arena from above. Pure.

import { isUnknown } from "../camera/words.js";

/** @typedef {"camera"|"arena"} View */

export class ViewChoice {
  #wanted;
  #hasArena = null; // not known yet
  #isThere = false; // the robot has a camera
  #hasBegun = false; // it has been live, or was asked for

  /** @param {View} wanted where there are both */
  constructor(wanted) {
    this.#wanted = wanted;
  }

  /** Whether the stage has a picture of the arena, too. @param {boolean} has */
  takeArena(has) {
    this.#hasArena = has;
  }

  /** News of the own robot's camera. @param {import("../camera/relay.js").CameraState} camera */
  take(camera) {
    if (camera.state === "none") this.#isThere = this.#hasBegun = false;
    else if (!isUnknown(camera)) this.#isThere = true;
    if (camera.state === "live") this.#hasBegun = true;
  }

  /** Whether the player can choose. */
  get canSwitch() {
    return this.#hasArena === true && this.#isThere;
  }

  /** @returns {View} "arena", too, where there is neither: the stage as it is without pictures */
  get view() {
    if (!this.#isThere) return "arena";
    return this.#hasArena === false || (this.#wanted === "camera" && this.#hasBegun) ? "camera" : "arena";
  }

  /** Whether nobody looks at the camera though it is there and works: it need not send anything. */
  get rests() {
    return this.view === "arena" && this.#hasBegun;
  }

  /** The other one. @returns {View} what the player wants now */
  toggle() {
    this.#wanted = this.view === "camera" ? "arena" : "camera";
    this.#hasBegun = true;
    return this.#wanted;
  }
}
