// Smooth motion between positions that arrive some times a second, none of which says when it was true. Pure.

const KEPT = 4; // the newest positions
const USUAL_GAP = 1 / 15; // s between two
const MOST_GAP = 0.25; // s; after a longer pause the motion begins anew
const TRUST = 0.2; // in the time at which positions came, against the beat that they keep: the network delays some
const SPARE = 0.02; // s that positions may be late and still come before they are needed
const AHEAD = 0.1; // s for which robots that nothing is heard of are drawn further on their way

const turn = (from, to) => Math.atan2(Math.sin(to - from), Math.cos(to - from));

export class Motion {
  constructor() {
    this.clear();
  }

  clear() {
    this.states = [];
    this.gap = USUAL_GAP;
    this.cameAt = -Infinity;
  }

  /** Robots as they are seen, received at `now` (s). */
  add(robots, now) {
    const last = this.states.at(-1);
    const passed = now - this.cameAt;
    if (passed > MOST_GAP) this.clear();
    else this.gap += 0.1 * (passed - this.gap);
    this.cameAt = now;
    const due = last && passed <= MOST_GAP ? last.time + this.gap : now;
    this.states.push({ time: due + TRUST * (now - due), robots });
    this.states.splice(0, this.states.length - KEPT);
  }

  /** The robots as they were one gap before `now` (s), so that there are positions on either side. */
  at(now) {
    const time = now - this.gap - SPARE;
    const later = this.states.findIndex((state) => state.time > time);
    const newer = later < 0 ? this.states.length - 1 : later;
    if (newer < 1) return this.states[0]?.robots ?? [];
    const [before, after] = [this.states[newer - 1], this.states[newer]];
    const between = after.time - before.time;
    const part = Math.min((time - before.time) / between, 1 + AHEAD / between);
    return after.robots.map((robot) => {
      const old = before.robots.find(({ name }) => name === robot.name);
      if (!old) return robot;
      return {
        ...robot,
        x: old.x + part * (robot.x - old.x),
        y: old.y + part * (robot.y - old.y),
        heading: old.heading + part * turn(old.heading, robot.heading),
      };
    });
  }
}
