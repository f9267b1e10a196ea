// Which picture a player's stage shows: that of the own robot's camera ("camera"), or the arena from above. Pure.

import { isUnknown } from "../camera/words.js";

/** @typedef {"camera"|"arena"} View */

export class ViewChoice {
  #hasArena;
  #wanted;
  #isThere = false; // the robot has a camera
  #hasBegun = false; // it has been live, or was asked for

  /** @param {boolean} hasArena @param {View} wanted where there are both */
  constructor(hasArena, wanted) {
    this.#hasArena = hasArena;
    this.#wanted = wanted;
  }

  /** News of the own robot's camera. @param {import("../camera/relay.js").CameraState} camera */
  take(camera) {
    if (camera.state === "none") this.#isThere = this.#hasBegun = false;
    else if (!isUnknown(camera)) this.#isThere = true;
    if (camera.state === "live") this.#hasBegun = true;
  }

  /** Whether the player can choose. */
  get canSwitch() {
    return this.#hasArena && this.#isThere;
  }

  /** @returns {View} "arena", too, where there is neither: the stage as it is without pictures */
  get view() {
    if (!this.#isThere) return "arena";
    return !this.#hasArena || (this.#wanted === "camera" && this.#hasBegun) ? "camera" : "arena";
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
