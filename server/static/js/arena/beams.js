// Laser light: cones that end at walls and robots, and its shine on what it falls on.

import { EMITTER } from "./memory.js";
import { fan } from "./rays.js";

const RAYS = 40; // gaps between the rays over the whole cone
const WIDTHS = [1, 0.65, 0.35, 0.1]; // of the layers, brighter towards the axis; multiples of 2 / RAYS
/** By the number of layers: fewer are brighter each. */
const STRENGTH = [0, 1.7, 1.3, 1.1, 1];

/**
 * Draw the beam of `robot`; the context is in metres, y up, adding light.
 * @param {number} layers from 1 to 4
 */
export function drawBeam(context, robot, robots, arena, layers) {
  const { beam_range: range, beam_half_angle: half, robot_radius: radius, walls } = arena;
  const x = robot.x + EMITTER * Math.cos(robot.heading);
  const y = robot.y + EMITTER * Math.sin(robot.heading);
  const others = robots.filter((other) => other.name !== robot.name);
  const rays = fan(x, y, robot.heading, half, RAYS, range, walls, others, radius);
  const ends = rays.map(({ angle, distance }) => [x + distance * Math.cos(angle), y + distance * Math.sin(angle)]);
  context.fillStyle = lightOf(context, x, y, range, STRENGTH[layers]);
  for (const width of WIDTHS.slice(0, layers)) {
    const middle = RAYS / 2;
    const reach = Math.round(width * middle);
    context.beginPath();
    context.moveTo(x, y);
    for (const end of ends.slice(middle - reach, middle + reach + 1)) context.lineTo(...end);
    context.fill();
  }
  drawShine(context, rays, ends);
}

function lightOf(context, x, y, range, strength) {
  const light = context.createRadialGradient(x, y, 0, x, y, range);
  light.addColorStop(0, `rgba(255, 80, 120, ${0.55 * strength})`);
  light.addColorStop(0.35, `rgba(255, 50, 95, ${0.26 * strength})`);
  light.addColorStop(0.85, `rgba(255, 40, 90, ${0.13 * strength})`);
  light.addColorStop(1, "rgba(255, 40, 90, 0)");
  return light;
}

/** Light on the chassis that it falls on. */
function drawShine(context, rays, ends) {
  context.lineCap = "round";
  context.beginPath();
  rays.forEach(({ robot }, n) => {
    if (!robot) return;
    if (rays[n - 1]?.robot === robot) context.lineTo(...ends[n]);
    else context.moveTo(...ends[n]);
  });
  for (const [width, colour] of [[0.045, "rgba(255, 61, 110, 0.22)"], [0.026, "rgba(255, 61, 110, 0.35)"], [0.01, "rgba(255, 190, 205, 0.9)"]]) {
    context.lineWidth = width;
    context.strokeStyle = colour;
    context.stroke();
  }
}
