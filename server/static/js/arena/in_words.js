// The picture in words, for those who do not see it.

import { t } from "../common/words.js";

/**
 * @param {{id: number}[]} robots
 * @param {(robot: object) => import("./roles.js").Player|undefined} playerOf who plays it
 */
export function inWords(robots, playerOf) {
  const inOrder = robots.toSorted((one, other) => one.id - other.id);
  return [t("arena.picture"), ...inOrder.map((robot) => wordsOf(robot, playerOf(robot)))].join(", ");
}

function wordsOf(robot, player) {
  if (!player) return t("arena.robot", { n: String(robot.id) });
  if (player.out) return t("arena.out", { name: player.name });
  return player.ready ? t("arena.life", { name: player.name, life: player.life }) : player.name;
}
