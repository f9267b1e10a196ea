// The camera's picture laid flat: with tilt and lens undone, seen from straight above. Pure.

import { NOTHING, pixelAt } from "./sight.js";

const LONGEST = 960; // pixels of a flat picture's longer side

/** @typedef {{left: number, bottom: number, right: number, top: number}} Frame what a picture shows of the floor, in m */
/** @typedef {{width: number, height: number, from: Int32Array}} Flat `from`: the pixel of the camera's picture, for each of the flat one */

/**
 * From where each pixel of the flat picture comes.
 * @param {import("./sight.js").Sight} sight
 * @param {Frame} frame
 * @param {number} height m above the floor of what is to be at its place
 * @returns {Flat}
 */
export function flatten(sight, { left, bottom, right, top }, height) {
  const metre = LONGEST / Math.max(right - left, top - bottom);
  const columns = Math.max(1, Math.round((right - left) * metre));
  const rows = Math.max(1, Math.round((top - bottom) * metre));
  const pixel = pixelAt(sight, height);
  const from = new Int32Array(columns * rows);
  for (let row = 0; row < rows; row++) {
    const y = top - ((row + 0.5) / rows) * (top - bottom);
    for (let column = 0; column < columns; column++) {
      from[row * columns + column] = pixel(left + ((column + 0.5) / columns) * (right - left), y);
    }
  }
  return { width: columns, height: rows, from };
}

/**
 * Fill the flat picture; transparent where the camera sees nothing.
 * @param {Uint32Array} picture the camera's pixels
 * @param {Flat} flat
 * @param {Uint32Array} pixels of the flat picture
 */
export function rectify(picture, { from }, pixels) {
  for (let n = 0; n < from.length; n++) pixels[n] = from[n] === NOTHING ? 0 : picture[from[n]];
}
