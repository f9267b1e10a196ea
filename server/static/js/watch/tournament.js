// The tournament on the screen in the hall: who plays next, where and when.

import { PLAYING } from "../battle/state.js";
import { championText, nextTexts } from "../battle/tournament.js";
import { TournamentFeed } from "../battle/tournament_feed.js";
import { element } from "../common/dom.js";
import { t } from "../common/words.js";

const SHOWN = 4; // matches

/** It makes its own place among the news, while a tournament is open. */
export class HallTournament {
  #feed = new TournamentFeed((tournament) => this.#show(tournament));
  #box = null;

  /** @param {import("../battle/status_feed.js").WatchedStatus} status */
  take(status) {
    this.#feed.take(status);
    if (this.#box) this.#box.hidden = status.game === PLAYING; // the arena needs the room
  }

  #show(tournament) {
    this.#box?.remove();
    this.#box = tournament && this.#view(tournament);
    if (this.#box) document.querySelector(".watch-news").append(this.#box);
  }

  #view(tournament) {
    const lines = [championText(tournament), ...nextTexts(tournament, SHOWN)].filter(Boolean);
    return element(
      "section",
      { className: "hall-tournament", ariaLabel: t("tournament.next") },
      element("h2", {}, element("a", { href: "/tournament" }, tournament.title)),
      element("ol", {}, ...lines.map((line) => element("li", {}, line))),
    );
  }
}
