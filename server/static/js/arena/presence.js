// Whether there are positions to draw. Pure; times in ms.

const WAIT = 2000; // from the beginning until it is said that there are none
const SILENCE = 3000; // between positions after which they are missed
const LATE = 3000; // between two looks, after which this page itself was too busy, or hidden, to hear anything

/** @typedef {"connecting"|"live"|"lost"|"none"} ArenaState "lost": there were positions; "none": there never were */

export class Presence {
  #heardAt;
  #lookedAt;
  /** @type {ArenaState} */
  state = "connecting";

  constructor(now) {
    this.#heardAt = this.#lookedAt = now;
  }

  /** Positions have come. */
  hear(now) {
    this.#heardAt = now;
    this.state = "live";
  }

  /** Time passes. */
  look(now) {
    if (now - this.#lookedAt > LATE) this.#heardAt = now; // what has come meanwhile is still to be read
    this.#lookedAt = now;
    const silence = now - this.#heardAt;
    if (this.state === "connecting" && silence >= WAIT) this.state = "none";
    if (this.state === "live" && silence >= SILENCE) this.state = "lost";
  }
}
