// Where the robots' labels stand so that all can be read. Pure; lengths in pixels, y down.

const GAP = 2; // between two labels
const ROUNDS = 80;
const POLITE = 20; // first rounds, in which labels keep off robots too

/** @typedef {{x: number, y: number, radius: number, width: number, height: number}} Tag a robot's place and its label's size */

/**
 * The label of a robot stands above it, below it at the picture's upper edge, and gives way to the others.
 * @param {Tag[]} tags
 * @param {number} width of the picture
 * @param {number} height of the picture
 * @returns {{left: number, top: number}[]}
 */
export function layOut(tags, width, height) {
  const boxes = tags.map((tag) => {
    const above = tag.y - tag.radius - tag.height / 2;
    const below = tag.y + tag.radius + tag.height / 2;
    return { x: tag.x, y: above >= tag.height / 2 ? above : below, width: tag.width, height: tag.height };
  });
  const keepInside = () => boxes.forEach((box) => clamp(box, width, height));
  keepInside();
  for (let round = 0; round < ROUNDS; round++) {
    if (round < POLITE) keepOffRobots(boxes, tags);
    // in a corner the shorter way may be shut: later rounds rather go sideways
    const isApart = !pushApart(boxes, round < POLITE ? 1 : 3);
    keepInside();
    if (isApart && round >= POLITE) break;
  }
  return boxes.map((box) => ({ left: box.x - box.width / 2, top: box.y - box.height / 2 }));
}

function clamp(box, width, height) {
  box.x = Math.max(box.width / 2, Math.min(box.x, width - box.width / 2));
  box.y = Math.max(box.height / 2, Math.min(box.y, height - box.height / 2));
}

/** Move every label out of the robots, up or down. */
function keepOffRobots(boxes, tags) {
  for (const box of boxes) {
    for (const { x, y, radius } of tags) {
      const inside = overlap(box, { x, y, width: 1.4 * radius, height: 1.4 * radius });
      if (inside) box.y += box.y < y ? -inside.y : inside.y;
    }
  }
}

/** Move labels that overlap by half of the shorter way out each; whether there were any. */
function pushApart(boxes, sideways) {
  let any = false;
  boxes.forEach((one, n) => {
    for (const other of boxes.slice(n + 1)) {
      const shared = overlap(one, other, GAP);
      if (!shared) continue;
      any = true;
      const side = shared.x < sideways * shared.y ? "x" : "y";
      const way = (other[side] < one[side] ? -shared[side] : shared[side]) / 2;
      one[side] -= way;
      other[side] += way;
    }
  });
  return any;
}

/** How far two boxes, given by their centres, go into each other; null if they do not. */
function overlap(one, other, gap = 0) {
  const x = (one.width + other.width) / 2 + gap - Math.abs(one.x - other.x);
  const y = (one.height + other.height) / 2 + gap - Math.abs(one.y - other.y);
  return x > 0.5 && y > 0.5 ? { x, y } : null;
}
