// One colour for each robot, by its ID, wherever it or its player is shown; common.css has them.

const COLOURS = 8;

/** Give an element its robot's colour, as --robot; a picture gets a ring. */
export function wearColour(node, robot) {
  const colour = String(robot % COLOURS);
  if (node.dataset.colour !== colour) node.dataset.colour = colour;
}
