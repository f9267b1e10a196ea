// Which robots are not seen, by /overhead/covered: for a moment only, since whoever tells it may be gone. Pure; times in ms.

const LASTS = 1500; // a robot that is covered has a place for 1 s, so that somebody who is there says something new by then

export class Covered {
  #robots = [];
  #heardAt = -Infinity;

  /** @param {number[]} robots IDs @param {number} now */
  hear(robots, now) {
    this.#robots = robots;
    this.#heardAt = now;
  }

  /** @param {number} now @returns {number[]} IDs */
  at(now) {
    return now - this.#heardAt <= LASTS ? this.#robots : [];
  }
}
