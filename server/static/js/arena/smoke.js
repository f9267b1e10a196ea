// Smoke over robots that are out.

const RISE = 2.2; // s that a puff lives
const DRIFT = 0.16; // m that it rises

/**
 * Draw the smoke of one robot; the context is in canvas pixels.
 * @param {ImageBitmap} puff
 * @param {{x: number, y: number, scale: number}} place in canvas pixels, `scale` for a metre
 * @param {number} count of puffs
 * @param {number} now s; the smoke stands still if it does
 */
export function drawSmoke(context, puff, { x, y, scale }, count, now) {
  for (let n = 0; n < count; n++) {
    const part = (now / RISE + n / count) % 1;
    const sway = 0.02 * Math.sin(9 * n + 5 * part);
    const size = puff.width * (0.35 + 0.65 * part);
    context.globalAlpha = 0.75 * Math.min(1, 6 * part) * (1 - part);
    context.drawImage(puff, x + sway * scale - size / 2, y - part * DRIFT * scale - size / 2, size, size);
  }
  context.globalAlpha = 1;
}
