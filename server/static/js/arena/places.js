// Places on the floor that mean something: hills, and what lies there to be picked up.

const HILL = 0; // kinds of laser_bot_battle/Place
const REPAIR = 1;
export const SHIELD = 2;
export const DOUBLE_DAMAGE = 3;
const COLOURS = ["255, 210, 94", "61, 255, 162", "120, 190, 255", "255, 122, 61"]; // by kind

/** @param {number} kind of laser_bot_battle/Place @param {number} alpha */
export const colourOfPlace = (kind, alpha) => `rgba(${COLOURS[kind] ?? COLOURS[HILL]}, ${alpha})`;

/**
 * Draw them; the context is in metres, y up.
 * @param {import("../battle/messages.js").Place[]} places
 */
export function drawPlaces(context, places) {
  context.lineCap = context.lineJoin = "round";
  for (const place of places) drawPlace(context, place);
}

function drawPlace(context, { kind, x, y, radius }) {
  const light = context.createRadialGradient(x, y, 0, x, y, radius);
  light.addColorStop(0, colourOfPlace(kind, kind === HILL ? 0.05 : 0.3));
  light.addColorStop(1, colourOfPlace(kind, kind === HILL ? 0.22 : 0.1));
  disc(context, x, y, radius);
  context.fillStyle = light;
  context.fill();
  context.strokeStyle = colourOfPlace(kind, 0.9);
  context.lineWidth = 0.006;
  if (kind === HILL) context.setLineDash([0.03, 0.02]);
  context.stroke();
  context.setLineDash([]);
  if (kind === HILL) return;
  context.lineWidth = radius * 0.16;
  context.stroke(sign(kind, x, y, radius * 0.5));
}

function disc(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

/** What a pick-up does: a cross repairs, a shield protects, two arrows hit twice as hard. */
function sign(kind, x, y, size) {
  const path = new Path2D();
  const lines = (...points) => points.forEach(([dx, dy], n) => path[n ? "lineTo" : "moveTo"](x + dx * size, y + dy * size));
  if (kind === REPAIR) {
    lines([-0.8, 0], [0.8, 0]);
    lines([0, -0.8], [0, 0.8]);
  } else if (kind === SHIELD) {
    lines([-0.75, 0.7], [0.75, 0.7], [0.75, 0], [0, -0.9], [-0.75, 0], [-0.75, 0.7]);
  } else {
    lines([-0.7, -0.1], [0, 0.8], [0.7, -0.1]);
    lines([-0.7, -0.9], [0, 0], [0.7, -0.9]);
  }
  return path;
}
