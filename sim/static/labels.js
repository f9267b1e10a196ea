// Where the robots' labels stand so that all can be read. Pure; lengths in pixels, y down.

const GAP = 2; // between two labels
const ROUNDS = 40;

/** @typedef {{x: number, y: number, radius: number, width: number, height: number}} Tag a robot's place and its label's size */

/**
 * The label of a robot stands above it, below it at the picture's upper edge, and gives way to the others.
 * @param {Tag[]} tags
 * @param {number} width of the picture
 * @param {number} height of the picture
 * @returns {{left: number, top: number}[]}
 */
export function layOut(tags, width, height) {
  const places = tags.map((tag) => {
    const above = tag.y - tag.radius - tag.height;
    return { left: tag.x - tag.width / 2, top: above >= 0 ? above : tag.y + tag.radius };
  });
  const keepInside = () => places.forEach((place, n) => clamp(place, tags[n], width, height));
  keepInside();
  for (let round = 0; round < ROUNDS && pushApart(places, tags, round); round++) keepInside();
  return places;
}

function clamp(place, tag, width, height) {
  place.left = Math.max(0, Math.min(place.left, width - tag.width));
  place.top = Math.max(0, Math.min(place.top, height - tag.height));
}

/** Move labels that overlap by half of the shorter way out each; whether there were any. */
function pushApart(places, tags, round) {
  let any = false;
  for (let one = 0; one < places.length; one++) {
    for (let other = one + 1; other < places.length; other++) {
      const [a, b] = [places[one], places[other]];
      const [dx, dy] = [centre(b.left, tags[other].width) - centre(a.left, tags[one].width), centre(b.top, tags[other].height) - centre(a.top, tags[one].height)];
      const x = (tags[one].width + tags[other].width) / 2 + GAP - Math.abs(dx);
      const y = (tags[one].height + tags[other].height) / 2 + GAP - Math.abs(dy);
      if (x <= 0.5 || y <= 0.5) continue;
      any = true;
      // in a corner the shorter way may be shut: later rounds try the other one too
      const sideways = round < ROUNDS / 2 ? x < y : x < 3 * y;
      if (sideways) shift(a, b, "left", dx < 0 ? -x : x);
      else shift(a, b, "top", dy < 0 ? -y : y);
    }
  }
  return any;
}

function shift(a, b, side, way) {
  a[side] -= way / 2;
  b[side] += way / 2;
}

const centre = (start, length) => start + length / 2;
