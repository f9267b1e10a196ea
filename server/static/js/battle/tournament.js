// What a tournament means to people: texts. Pure.

import { t } from "../common/words.js";

/**
 * @typedef {object} Match of /tournament.json
 * @property {number} number
 * @property {(string|null)[]} players two; null: not known yet
 * @property {{what: string, number: number, place: number|null}[]} sources where they come from
 * @property {number[]} wins
 * @property {string|null} winner
 * @property {boolean} called it is to be played now
 * @property {number[]|null} robots of its players, while it is called
 * @property {number|null} seconds about when it begins; null: it does not
 */

/** About when a match begins. @param {number} seconds */
export const whenText = (seconds) => t("tournament.minutes", { n: Math.max(1, Math.round(seconds / 60)) });

/** Who will come, before it is known. @param {{what: string, number: number, place: number|null}} source */
export const sourceText = ({ what, number: n, place }) => t(`tournament.from_${what}`, { n: String(n), place: String(place) });

/** Who a player is, or where that one will come from. */
const sideText = (match, side) => match.players[side] ?? sourceText(match.sources[side]);

/** The matches that are still to be played, the one that is called first. */
export function nextMatches({ open, matches }, most) {
  if (!open) return [];
  const pending = matches.filter(({ winner }) => winner === null);
  return pending.sort((one, other) => one.seconds - other.seconds).slice(0, most);
}

/** One of them in a line: who, and where or when. @param {Match} match */
export function matchText(match) {
  const [one, other] = [sideText(match, 0), sideText(match, 1)];
  const { robots, seconds } = match;
  const when = robots
    ? t("tournament.now_robots", { one, robot: String(robots[0]), other, second: String(robots[1]) })
    : `${t("tournament.versus", { one, other })}, ${whenText(seconds)}`;
  return `${t("tournament.match", { n: String(match.number) })}: ${when}`;
}

/** What a player has to know of it; empty: nothing. @param {object|null} tournament of /tournament.json @param {string} name */
export function ownText(tournament, name) {
  if (!tournament?.open) return "";
  const called = tournament.matches.find((match) => match.called);
  const isOwn = ({ players }) => players.some((player) => player !== null && isSame(player, name));
  const own = nextMatches(tournament, Infinity).find(isOwn);
  if (own) return ownMatch(own, name);
  if (!called) return "";
  return t("tournament.others_now", { n: String(called.number), one: called.players[0], other: called.players[1] });
}

function ownMatch(match, name) {
  const side = match.players.findIndex((player) => player !== null && isSame(player, name));
  const n = String(match.number);
  const rival = match.players[1 - side];
  if (match.called) return t("tournament.you_now", { n, name: rival, robot: String(match.robots[side]) });
  const when = whenText(match.seconds);
  if (rival !== null) return t("tournament.you_next", { n, name: rival, when });
  return t("tournament.you_open", { n, when, source: sourceText(match.sources[1 - side]) });
}

/** As the server compares names: "ß" is "ss" there, which only capital letters tell here. */
const isSame = (one, other) => folded(one) === folded(other);
const folded = (name) => name.normalize("NFKC").toUpperCase().toLowerCase().normalize("NFKC");

/** The next matches for the hall, as one line each. */
export const nextTexts = (tournament, most) => nextMatches(tournament, most).map(matchText);

/** Who has won, in words; empty: nobody yet. */
export const championText = ({ champion }) => (champion ? t("tournament.won", { name: champion }) : "");
