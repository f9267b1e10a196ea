// The arena from above on the game page's stage, as soon as something tells where the robots are.

import { ArenaView } from "../arena/arena_view.js";
import { RealFloor } from "../overhead/real_floor.js";
import { t } from "../common/words.js";
import { showArenaNote } from "./view.js";

/**
 * @param {object} wiring
 * @param {import("../common/preferences_store.js").Preferences} wiring.preferences
 * @param {() => Promise<{user: string, ticket: string}|null>} wiring.getTicket for the player of this page
 * @param {(state: import("../arena/presence.js").ArenaState) => void} wiring.onState on each change
 * @returns {{arena: ArenaView, realFloor: RealFloor}}
 */
export function openArena({ preferences, getTicket, onState }) {
  const box = document.getElementById("arena");
  const take = (state) => {
    document.body.dataset.arena = state;
    showArenaNote(state === "lost" ? t("game.arena_lost") : "");
    onState(state);
  };
  const arena = new ArenaView(box, take, (frame) => realFloor.show(frame));
  const realFloor = new RealFloor({ box, preferences, getTicket, onPicture: (picture) => (arena.realFloor = picture) });
  return { arena, realFloor };
}
