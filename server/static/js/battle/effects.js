// What pick-ups and the floor's edge do to robots. Pure.

import { t } from "../common/words.js";

export const SHIELD = 1; // of a player's effects, as in UserStatus.msg
export const DOUBLE_DAMAGE = 2;

/** What a player's robot has of pick-ups, and that it is stopped at the floor's edge, in words for others; empty if nothing is so. */
export const effectsText = ({ effects, fence, life }) =>
  [
    life > 0 && effects & SHIELD && t("game.has_shield"),
    life > 0 && effects & DOUBLE_DAMAGE && t("game.has_double_damage"),
    fence > 0 && t("game.is_stopped"),
  ]
    .filter(Boolean)
    .join(", ");
