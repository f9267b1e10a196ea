// The words for those who wait for a robot. Pure.

import { list, t } from "../common/words.js";
import { STOPPED } from "./state.js";

/** What /session says of somebody who waits.
 * @typedef {{user: string, place: number, offer: number|null, seconds: number}} Waiter */

/** @param {Waiter} waiter @returns {{title: string, text: string, tab?: string}} `tab`: for the title of the page while there is an offer */
export function queueText({ place, offer, seconds }) {
  if (offer !== null) {
    const values = { id: offer, n: seconds };
    return { title: t("queue.offer", values), text: t("queue.offer_text", values), tab: t("queue.offer_tab", values) };
  }
  const title = place === 1 ? t("queue.next") : t("queue.place", { n: place });
  return { title, text: t("queue.wait", { time: waitText(seconds) }) };
}

/** Who fights meanwhile, or is about to; empty without a battle. @param {import("./messages.js").Status} status */
export function battleText({ game, users }) {
  const fighters = users.filter((user) => user.ready && user.life > 0);
  return game === STOPPED ? "" : t("queue.battle", { names: list(fighters.map((user) => user.name)) });
}

/** Seconds as people say them. */
export function waitText(seconds) {
  const n = Math.round(seconds / 60);
  return n < 1 ? t("queue.a_minute") : t("queue.minutes", { n });
}
