// What the things on the floor are called.

import { number, t } from "../common/words.js";

/** @param {import("./floor_plan.js").Plan} plan @param {import("./floor_plan.js").Thing} thing */
export function nameOf(plan, { list, index }) {
  if (list === "walls") return t("floor.wall_n", { n: index + 1 });
  if (list === "starts") return t("floor.start_n", { n: index + 1 });
  const { kind, name } = plan.zones[index];
  return t(kind === "hill" ? "floor.hill_n" : "floor.pickup_n", { name });
}

/** Where it is, in a few words. */
export function placeOf(plan, { list, index }) {
  const one = plan[list][index];
  const [x1, y1, x2, y2] = list === "zones" ? [one.x, one.y] : one;
  const point = (x, y) => `${metres(x)} / ${metres(y)}`;
  return list === "walls" ? `${point(x1, y1)} – ${point(x2, y2)}` : point(x1, y1);
}

const metres = (value) => (Number.isFinite(value) ? number(value, { maximumFractionDigits: 3 }) : "?");
