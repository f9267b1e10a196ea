// What a screen for spectators shows at which moment. Pure.

import { COUNTDOWN, PLAYING } from "../battle/state.js";

export const PODIUM = 15_000; // ms
export const TURN = 12_000; // ms of leaderboard and invitation each

/** @typedef {"none"|"join"|"leaders"|"countdown"|"battle"|"podium"} Panel */

export class ScreenSchedule {
  #game = null; // null before the first state
  #endedAt = -Infinity;
  #idleSince = 0;

  /**
   * A new state of the battle.
   * @param {import("../battle/messages.js").Status} status
   * @param {import("../battle/feed.js").Change[]} news what has changed
   * @param {number} now ms
   */
  take(status, news, now) {
    const isFirst = this.#game === null;
    this.#game = status.game;
    if (news.some((change) => change.kind === "end")) {
      this.#endedAt = now;
      this.#idleSince = now + PODIUM;
    } else if (isFirst || this.isBusy) {
      this.#endedAt = -Infinity;
      this.#idleSince = now;
    }
  }

  /** Whether a battle runs or begins. */
  get isBusy() {
    return this.#game === COUNTDOWN || this.#game === PLAYING;
  }

  /**
   * @param {number} now ms
   * @param {boolean} hasLeaders whether there is a leaderboard to show
   * @param {boolean} hasVote whether people vote, which takes the podium's place
   * @returns {Panel}
   */
  panel(now, hasLeaders, hasVote) {
    if (this.#game === null) return "none";
    if (this.#game === COUNTDOWN) return "countdown";
    if (this.#game === PLAYING) return "battle";
    if (now - this.#endedAt < PODIUM && !hasVote) return "podium";
    const turn = Math.floor((now - this.#idleSince) / TURN);
    return hasLeaders && turn % 2 === 0 ? "leaders" : "join";
  }
}
