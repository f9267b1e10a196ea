// What a player has done in the battle that runs: for the page after it. Pure.

import { PLAYING, findUser, lifeLost } from "../battle/state.js";

export class OwnStats {
  #name;
  #now;
  #battle = null; // number of the battle that is counted
  #began = 0;
  #ended = null; // when this player was out
  #hits = 0;
  #shots = 0;

  /**
   * @param {string} name the player
   * @param {() => number} now ms
   */
  constructor(name, now) {
    this.#name = name;
    this.#now = now;
  }

  /** @param {import("../battle/messages.js").Status|null} previous */
  take(previous, current) {
    const me = findUser(current, this.#name);
    if (current.game === PLAYING && current.battle !== this.#battle && me?.ready) {
      [this.#battle, this.#began, this.#ended, this.#hits, this.#shots] = [current.battle, this.#now(), null, 0, 0];
    }
    if (lifeLost(previous, current, this.#name) > 0) this.#hits += 1;
    if (this.#ended === null && (current.game !== PLAYING || me?.life === 0)) this.#ended = this.#now();
  }

  shot() {
    this.#shots += 1;
  }

  /** @returns {{hits: number, shots: number, seconds: number}} of the last battle */
  get values() {
    return { hits: this.#hits, shots: this.#shots, seconds: ((this.#ended ?? this.#now()) - this.#began) / 1000 };
  }
}
