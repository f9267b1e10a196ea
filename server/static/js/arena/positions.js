// What a message of /positions says: strangers' data until it has been looked at. Pure.

import { DIMENSIONS } from "./dimensions.js";

const MOST_SIDE = 100; // m, as for bots
const MOST_ROBOTS = 128; // as many IDs as there are
const MOST_WALLS = 1000;

/** @typedef {{id: number, name: string, x: number, y: number, heading: number, covered: boolean}} Pose in m and rad; `name` is nobody
 *   else's; covered: it is not seen, and the place is predicted */
/** @typedef {{width: number, height: number, walls: number[][], robot_radius: number, beam_range: number,
 *   beam_half_angle: number}} Floor */

/**
 * The floor and the robots of a laser_bot_battle/Positions; null if it has no floor. Poses that are no places, and all
 * but the first of a robot, are left out.
 * @param {object} message
 * @param {number[]} covered as /overhead/covered says
 * @returns {{floor: Floor, robots: Pose[]}|null}
 */
export function readPositions({ width, height, walls, robots }, covered = []) {
  if (![width, height].every((side) => side > 0 && side <= MOST_SIDE)) return null;
  const poses = new Map();
  for (const { robot, x, y, heading } of robots.slice(0, MOST_ROBOTS)) {
    const isPlace = [x, y, heading].every(Number.isFinite); // rosbridge sends null for what is no number
    if (!isPlace || poses.has(robot)) continue;
    poses.set(robot, { id: robot, name: `Robot${robot}`, x, y, heading, covered: covered.includes(robot) });
  }
  return { floor: { width, height, walls: quartets(walls), ...DIMENSIONS }, robots: [...poses.values()] };
}

/** Ends of walls, four numbers each; what is left of an incomplete one is nothing. */
function quartets(ends) {
  const count = Math.min(MOST_WALLS, Math.floor(ends.length / 4));
  return Array.from({ length: count }, (_, n) => ends.slice(4 * n, 4 * n + 4)).filter((wall) => wall.every(Number.isFinite));
}
