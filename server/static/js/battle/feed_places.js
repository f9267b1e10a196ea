// What the rules of place have done between two states of the battle, as the feed tells it.

import { DOUBLE_DAMAGE, SHIELD } from "./effects.js";
import { ofPlayer } from "./feed.js";
import { isSameBattle } from "./hits.js";
import { PLAYING } from "./state.js";

/** @typedef {import("./messages.js").Status} Status */

// s of the battle in which what goes on is told once: each second on a hill is a point, and who pushes against the edge is stopped each time
const GOES_ON = { hill: 2.5, fenced: 15 };

export class PlaceNews {
  #last = new Map(); // by kind and whose it was: the time left then

  /**
   * Who is stopped at the edge, takes a hill, or has picked something up. States in between may be missing.
   * @param {Status|null} previous
   * @param {Status} current
   * @returns {import("./feed.js").Change[]}
   */
  take(previous, current) {
    if (previous?.game !== PLAYING || current.game !== PLAYING || !isSameBattle(previous, current)) {
      this.#last.clear();
      return [];
    }
    const before = new Map(previous.users.filter(({ ready }) => ready).map((user) => [user.name, user]));
    return current.users.flatMap((user) => {
      const old = before.get(user.name);
      if (!old || !user.ready) return [];
      const gained = user.effects & ~old.effects;
      const kinds = [
        user.fence && !old.fence && this.#isNew("fenced", user.name, current) && "fenced",
        user.points > old.points && this.#isNew("hill", user.team || user.name, current) && "hill",
        user.life > old.life && "repair",
        gained & SHIELD && "shield",
        gained & DOUBLE_DAMAGE && "double_damage",
      ];
      return kinds.filter(Boolean).map((kind) => ofPlayer(kind, user));
    });
  }

  #isNew(kind, whose, { timeLeft }) {
    const key = `${kind} ${whose}`;
    const last = this.#last.get(key) ?? Infinity;
    this.#last.set(key, timeLeft);
    return Math.abs(last - timeLeft) > GOES_ON[kind];
  }
}
