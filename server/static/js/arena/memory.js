// What the picture remembers of each robot from one frame to the next: its track, how its wheels turn, its last hit. Pure.

export const EMITTER = 0.06; // m ahead of a robot's centre; the wheels are as far from it, to either side
export const TRACK_SECONDS = 2.5; // that tyre tracks are seen
const FLASH_SECONDS = 0.6;
const STEP = 0.008; // m between two points of a track
const JUMP = 0.5; // m; farther than that a robot has not driven from one picture to the next

/** @typedef {{x: number, y: number, heading: number, hits: number, hitAt: number, wheels: [number, number],
 *   track: {x: number, y: number, time: number}[]}} Remembered `wheels` = how far (m) left and right have rolled */

export class Memory {
  #robots = new Map();

  /** What is known of a robot that follow() has seen. @returns {Remembered} */
  of(robot) {
    return this.#robots.get(robot.name);
  }

  /** Take the robots as they are at `now` (s); returns those that have just been hit. */
  follow(robots, now) {
    const present = new Set(robots.map(({ name }) => name));
    for (const name of this.#robots.keys()) if (!present.has(name)) this.#robots.delete(name);
    return robots.filter((robot) => this.#take(robot, now));
  }

  clear() {
    this.#robots.clear();
  }

  /** From 1 at a hit of the robot down to 0 some time after it. */
  flash(robot, now) {
    return Math.max(0, 1 - (now - this.of(robot).hitAt) / FLASH_SECONDS);
  }

  /** Whether there are tracks that fade. */
  get hasTracks() {
    return [...this.#robots.values()].some(({ track }) => track.length > 1);
  }

  #take(robot, now) {
    const { x, y, heading, hits } = robot;
    const old = this.of(robot) ?? { x, y, heading, hits, hitAt: -Infinity, wheels: [0, 0], track: [] };
    const turn = Math.atan2(Math.sin(heading - old.heading), Math.cos(heading - old.heading));
    const ahead = (x - old.x) * Math.cos(heading) + (y - old.y) * Math.sin(heading);
    const wheels = [old.wheels[0] + ahead - turn * EMITTER, old.wheels[1] + ahead + turn * EMITTER];
    const isThere = Math.hypot(x - old.x, y - old.y) < JUMP;
    const track = isThere ? old.track.filter((point) => now - point.time < TRACK_SECONDS) : [];
    const last = track.at(-1);
    if (!last || Math.hypot(last.x - x, last.y - y) > STEP) track.push({ x, y, time: now });
    const isHit = hits > old.hits;
    this.#robots.set(robot.name, { x, y, heading, hits, hitAt: isHit ? now : old.hitAt, wheels, track });
    return isHit;
  }
}
