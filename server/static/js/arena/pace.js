// How often the picture is drawn: as often as can be seen, and never while it stays as it is. Pure.

/** Pictures a second that are worth drawing, by what goes on in them besides the robots' motion. */
export const REST = 0;
export const DRIFT = 15; // smoke rises, tracks fade
export const MOTION = 60;

const SEEN = 0.5; // pixels; nobody sees a shorter way
const LOOKS = ["name", "id", "beam", "hits", "covered"]; // of a robot, besides its place

/**
 * Whether robots would be seen to be elsewhere, or other ones.
 * @param {object[]} before robots as they are drawn
 * @param {object[]} after robots as they are now
 * @param {{robot_radius: number, beam_range: number}} arena
 * @param {number} scale pixels for a metre
 */
export function isOther(before, after, arena, scale) {
  if (before.length !== after.length) return true;
  return after.some((robot, n) => LOOKS.some((look) => robot[look] !== before[n][look]) || scale * way(before[n], robot, arena) >= SEEN);
}

/** m that the part of a robot has gone which has gone farthest. */
function way(before, after, { robot_radius: radius, beam_range: range }) {
  const turned = after.heading - before.heading;
  const reach = after.beam ? range : radius;
  return Math.hypot(after.x - before.x, after.y - before.y) + reach * Math.abs(Math.atan2(Math.sin(turned), Math.cos(turned)));
}

/** Whether the next of `pace` pictures a second is due `since` s after the last one. */
export const isDue = (pace, since) => since > 0.8 / pace; // the screen's pictures come a bit early, too
