// Who shoots and who is hit, as rosbridge's /shots and the referee's news tell it. Pure.

import { newHits } from "../battle/hits.js";

const SHINE = 0.3; // s that a shot is shown: coded light's 25 ms are too short for eyes

export class Shooting {
  #shining = new Map(); // robot's ID -> s until when
  #hits = new Map(); // robot's ID -> how many
  #status = null; // the last one

  /** `robot` shoots at `now` (s). */
  shoot(robot, now) {
    this.#shining.set(robot, now + SHINE);
  }

  /**
   * A new state of the battle has arrived.
   * @param {import("../battle/messages.js").Status} status
   * @returns {boolean} whether it tells of hits
   */
  take(status) {
    const hits = newHits(this.#status, status);
    const robots = new Map([...status.result, ...status.users].map(({ name, robot }) => [name, robot]));
    for (const { name } of hits) {
      const robot = robots.get(name);
      this.#hits.set(robot, (this.#hits.get(robot) ?? 0) + 1);
    }
    this.#status = status;
    return hits.length > 0;
  }

  /** The robots with their `beam` and how many `hits` each has taken since the page has been here. */
  on(robots, now) {
    return robots.map((robot) => ({ ...robot, beam: now < (this.#shining.get(robot.id) ?? 0), hits: this.#hits.get(robot.id) ?? 0 }));
  }
}
