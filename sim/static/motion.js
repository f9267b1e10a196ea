// Smooth motion between the states that arrive 25 times a second, or 10 times in a crowd.

const KEPT = 12; // states
const USUAL_GAP = 0.04; // s between two states

/** s that the picture is behind the newest state, so that there is a state on either side. */
const delayFor = (gap) => 0.02 + 1.5 * gap;

const turn = (from, to) => Math.atan2(Math.sin(to - from), Math.cos(to - from));

export class Motion {
  constructor() {
    this.clear();
  }

  clear() {
    this.states = [];
    this.offset = Infinity;
    this.gap = USUAL_GAP;
  }

  /** A state of the view, received at `now` (s). */
  add(state, now) {
    const last = this.states.at(-1);
    if (last && state.time <= last.time) this.clear(); // the arena started again
    else if (last) this.gap += 0.1 * (Math.min(0.25, state.time - last.time) - this.gap);
    this.states.push(state);
    this.states.splice(0, this.states.length - KEPT);
    // The least delayed message tells best how the arena's clock relates to ours; let go slowly of what is outdated.
    this.offset = Math.min(this.offset + 0.0005, now - state.time);
  }

  /** The robots as they were shortly before `now` (s). */
  at(now) {
    const time = now - this.offset - delayFor(this.gap);
    const later = this.states.findIndex((state) => state.time > time);
    if (later < 0) return this.states.at(-1)?.robots ?? [];
    if (later === 0) return this.states[0].robots;
    const [before, after] = [this.states[later - 1], this.states[later]];
    const part = (time - before.time) / (after.time - before.time);
    return after.robots.map((robot) => {
      const old = before.robots.find((other) => other.name === robot.name);
      if (!old) return robot;
      return {
        ...old,
        x: old.x + part * (robot.x - old.x),
        y: old.y + part * (robot.y - old.y),
        heading: old.heading + part * turn(old.heading, robot.heading),
      };
    });
  }
}
