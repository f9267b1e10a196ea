// What the entrance says of its arenas. Pure.

import { t } from "../common/words.js";

/**
 * @typedef {object} Arena as the server tells it (docs/scale.md)
 * @property {string} name
 * @property {string} address of its pages, or a port, such as ":30510", of the host that served this page
 * @property {"away"|"stopped"|"countdown"|"playing"|"tournament"} state
 * @property {number} [free] robots
 * @property {number} [players]
 * @property {number} [waiting] for a robot
 */

/** Where the arena's pages are. @param {string} address @param {string} hostname of this page */
export const arenaUrl = (address, hostname) => (address.startsWith(":") ? `http://${hostname}${address}` : address);

/** All in one line. @param {Arena[]} arenas */
export function summaryText(arenas) {
  const there = arenas.filter(({ state }) => state !== "away");
  if (there.length === 0) return t("entrance.all_away");
  const n = there.reduce((sum, { free }) => sum + free, 0);
  const waiting = there.reduce((sum, one) => sum + one.waiting, 0);
  if (n > 0) return t("login.free", { n });
  return t("entrance.none_free", { n: waiting });
}

/** What happens in an arena. @param {Arena} arena */
export function stateText({ state, free }) {
  if (state === "stopped") return t(free > 0 ? "entrance.state_open" : "entrance.state_full");
  return t(`entrance.state_${state}`);
}

/** Who is there, in one line. @param {Arena} arena */
export function countsText({ state, free, players, waiting }) {
  if (state === "away") return t("entrance.away");
  const counts = [t("login.free", { n: free }), t("entrance.players", { n: players })];
  if (waiting > 0) counts.push(t("entrance.waiting", { n: waiting }));
  return counts.join(" · ");
}

/** Why a visitor could not be sent anywhere. @param {string} status the server's word */
export function problemText(status) {
  switch (status) {
    case "BAD_NAME":
      return t("login.bad_name");
    case "RESERVED_NAME":
      return t("entrance.reserved");
    case "NO_ARENAS":
      return t("entrance.all_away");
    case "TOO_FAST":
      return t("entrance.too_fast");
    default:
      return t("login.no_answer_text");
  }
}
