// The tournament for a player: against whom, when, and with which robot.

import { ownText } from "./tournament.js";
import { TournamentFeed } from "./tournament_feed.js";
import { setText } from "../common/dom.js";

export class OwnTournament {
  #name;
  #box;
  #feed = new TournamentFeed((tournament) => this.#show(tournament));

  /** @param {string} name the player @param {HTMLElement} box is hidden while there is nothing to say */
  constructor(name, box) {
    this.#name = name;
    this.#box = box;
  }

  /** @param {import("./messages.js").Status} status */
  take(status) {
    this.#feed.take(status);
  }

  #show(tournament) {
    const text = ownText(tournament, this.#name);
    this.#box.hidden = text === "";
    setText(this.#box, text);
  }
}
