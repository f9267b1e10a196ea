// How the camera above the floor sees it, as a message of /overhead/view says: strangers' data until it has been looked at.
// The same as server/overhead/view.py, the other way round: from the floor to the picture. Pure.

const MOST_PIXELS = 4_000_000; // as many as the tracker looks at
export const NOTHING = -1; // instead of a pixel: the camera does not see that

/**
 * @typedef {object} Sight
 * @property {number} width of the camera's pictures, in pixels
 * @property {number} height likewise
 * @property {number[]} homography 3 x 3, row by row
 * @property {number} bend of the lens
 * @property {number[]} camera its x, y and height over the floor, m
 * @property {number} tagHeight of the tags on robots over the floor, m
 */

/** @returns {Sight|null} null while the tracker does not know where the floor is in the picture */
export function readSight({ width, height, homography, bend, camera, tag_height }) {
  const isPicture = width > 0 && height > 0 && width * height <= MOST_PIXELS;
  const isSight = homography.length === 9 && camera.length === 3 && [...homography, ...camera, bend, tag_height].every(Number.isFinite);
  if (!isPicture || !isSight || camera[2] <= tag_height) return null;
  return { width, height, homography, bend, camera, tagHeight: tag_height };
}

/**
 * Which pixel shows what is `height` m above the floor: what is higher seems farther from below the camera.
 * @param {Sight} sight
 * @returns {(x: number, y: number) => number} from m to the pixel's place among all, row by row; or NOTHING
 */
export function pixelAt({ width, height: rows, homography: [a, b, c, d, e, f, g, h, i], bend, camera: [overX, overY, above] }, height) {
  const stretch = above / (above - height);
  const farthest = bend < 0 ? -1 / (3 * bend) : Infinity; // squared; beyond it such a lens would show everything a second time
  return (x, y) => {
    const floorX = overX + (x - overX) * stretch;
    const floorY = overY + (y - overY) * stretch;
    const depth = g * floorX + h * floorY + i;
    const across = (a * floorX + b * floorY + c) / depth;
    const down = (d * floorX + e * floorY + f) / depth;
    const distance = across * across + down * down;
    if (!(distance < farthest)) return NOTHING;
    const scale = (1 + bend * distance) * (width / 2);
    const column = Math.floor(width / 2 + across * scale);
    const row = Math.floor(rows / 2 + down * scale);
    return column >= 0 && column < width && row >= 0 && row < rows ? row * width + column : NOTHING;
  };
}
