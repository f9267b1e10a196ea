// The arena from above on the game page's stage.

import { arenaAddress } from "../common/addresses.js";
import { ArenaView } from "../common/arena_view.js";
import { showArenaNote } from "./view.js";
import { t } from "../common/words.js";

/** The arena's picture on the stage, where there is one: it is on the host that served this page. */
export function openArena() {
  const url = arenaAddress();
  if (!url) return null;
  document.body.classList.add("has-arena");
  return new ArenaView({
    frame: document.getElementById("arena"),
    url,
    onState: (arena) => {
      document.body.dataset.arena = arena;
      showArenaNote(arena === "live" ? "" : t(`game.arena_${arena}`));
    },
  });
}
