// The tournament for a player: against whom, when, and with which robot. Out of the way while a battle runs.

import { setText } from "../common/dom.js";
import { STOPPED } from "./state.js";
import { ownText } from "./tournament.js";
import { TournamentFeed } from "./tournament_feed.js";

export class OwnTournament {
  #box;
  #text = "";
  #feed;

  /**
   * @param {string} name the player
   * @param {HTMLElement} box is hidden while there is nothing to say
   * @param {object} [world] see TournamentFeed
   */
  constructor(name, box, world) {
    this.#box = box;
    this.#feed = new TournamentFeed((tournament) => this.#say(ownText(tournament, name)), world);
  }

  /** @param {import("./messages.js").Status} status */
  take(status) {
    this.#feed.take(status);
    this.#box.hidden = this.#text === "" || status.game !== STOPPED;
  }

  #say(text) {
    this.#text = text; // the next status shows it
    setText(this.#box, text);
  }
}
