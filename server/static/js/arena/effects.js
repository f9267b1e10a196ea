// What a robot that has picked something up looks like. The context is in metres, with the robot's middle as its origin.

import { colourOfPlace, DOUBLE_DAMAGE, SHIELD } from "./places.js";

export const REACH = 1.7; // of a robot's radius

const RAYS = 12;

/** A ring in the colour of the pick-up. */
export function paintShield(context, radius) {
  context.strokeStyle = colourOfPlace(SHIELD, 0.95);
  context.lineWidth = 0.1 * radius;
  context.beginPath();
  context.arc(0, 0, 1.3 * radius, 0, 2 * Math.PI);
  context.stroke();
}

/** Rays, beyond the ring. */
export function paintRays(context, radius) {
  context.strokeStyle = colourOfPlace(DOUBLE_DAMAGE, 0.95);
  context.lineWidth = 0.1 * radius;
  context.lineCap = "round";
  context.beginPath();
  for (let n = 0; n < RAYS; n++) {
    const [x, y] = [Math.cos((2 * Math.PI * n) / RAYS), Math.sin((2 * Math.PI * n) / RAYS)];
    context.moveTo(1.42 * radius * x, 1.42 * radius * y);
    context.lineTo(1.62 * radius * x, 1.62 * radius * y);
  }
  context.stroke();
}
