// The first steps of somebody who has never driven: three hints, each until it is done. Pure.

import { PLAYING, hasEnded, phaseOf } from "../battle/state.js";
import { t } from "../common/words.js";

/** @typedef {"drive"|"turn"|"shoot"} Step */

/** Step -> the driver's actions that do it. @type {[Step, string[]][]} */
const STEPS = [
  ["drive", ["up", "down"]],
  ["turn", ["left", "right"]],
  ["shoot", ["shoot"]],
];

export class FirstSteps {
  #left = new Map(STEPS);
  #isMidway = false; // the page was opened while its player was fighting: that one has been driving

  /** A new state of the battle has arrived. @param {import("../battle/messages.js").Status|null} previous */
  take(previous, current, name) {
    if (previous === null) this.#isMidway = phaseOf(current, name) === "playing";
    else if (current.game !== PLAYING) this.#isMidway = false;
    if (hasEnded(previous, current, name)) this.skip(); // whoever has fought knows
  }

  /** The player holds these actions, and the robot obeys. @param {Iterable<string>} actions */
  act(actions) {
    const held = new Set(actions);
    for (const [step, doing] of this.#left) {
      if (doing.some((action) => held.has(action))) this.#left.delete(step);
    }
  }

  /** No more of them. */
  skip() {
    this.#left.clear();
  }

  get isDone() {
    return this.#left.size === 0;
  }

  /** The hint to give now. @returns {{step: Step, n: number, all: number}|null} null: none, or not in this battle */
  get hint() {
    if (this.isDone || this.#isMidway) return null;
    const [step] = this.#left.keys();
    return { step, n: STEPS.length - this.#left.size + 1, all: STEPS.length };
  }
}

/**
 * A hint in words: what to do with what the player holds, and what is to be seen then.
 * @param {Step} step
 * @param {"keys"|"pad"|"stick"|"gamepad"} device
 * @param {"camera"|"arena"|"none"} view what the stage shows
 * @param {number} robot the player's
 * @returns {{text: string, sight: string}}
 */
export function hintText(step, device, view, robot) {
  const values = { you: t("game.you"), fire: t("controls.fire"), id: String(robot) };
  return { text: t(`guide.${step}_${device}`, values), sight: t(`guide.sight_${step === "drive" ? view : step}`, values) };
}
