// The arena from above on the game page's stage, as soon as something tells where the robots are.

import { ArenaView } from "../arena/arena_view.js";
import { t } from "../common/words.js";
import { showArenaNote } from "./view.js";

/** @param {(state: import("../arena/presence.js").ArenaState) => void} onState on each change */
export function openArena(onState) {
  return new ArenaView(document.getElementById("arena"), (state) => {
    document.body.dataset.arena = state;
    showArenaNote(state === "lost" ? t("game.arena_lost") : "");
    onState(state);
  });
}
