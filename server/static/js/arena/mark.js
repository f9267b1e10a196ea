// What shows the player the own robot: a ring, and waves that run towards it when a battle begins.

const WAVES = 3.2; // s that they run
const WAVE = 0.8; // s of one
const FAR = 0.45; // m from where a wave comes

/** Whether waves run `since` s after the battle has begun. */
export const isCalling = (since) => since >= 0 && since < WAVES;

/**
 * Draw around the robot's centre; the context is in metres, y up.
 * @param {number} since s since the battle has begun
 * @param {boolean} still nothing moves
 */
export function drawMark(context, { x, y }, radius, colour, since, still) {
  const begins = isCalling(since);
  ring(context, x, y, radius * 1.3, begins ? 0.016 : 0.009, "#ffffff", 1);
  ring(context, x, y, radius * 1.3, 0.03, colour, 0.45);
  if (!begins) return;
  if (still) {
    ring(context, x, y, radius * 2, 0.016, "#ffffff", 0.9);
    return;
  }
  for (const start of [0, 0.5]) {
    const part = (since / WAVE + start) % 1;
    ring(context, x, y, radius * 1.3 + FAR * (1 - part), 0.012, "#ffffff", part);
  }
}

function ring(context, x, y, radius, width, colour, alpha) {
  context.globalAlpha = alpha;
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.stroke();
  context.globalAlpha = 1;
}
