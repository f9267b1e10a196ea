// Teams: their names, their colours in the arena, and how they stand at the end. Pure.

import { t } from "../common/words.js";

/** @typedef {import("./messages.js").Player} Player */

export const MOST_TEAMS = 4;

const ARENA = ["#ff7d6e", "#7fb0ff", "#2ed58a", "#ffd23e"]; // as common.css has them for the night

/** "Red", for 1 to MOST_TEAMS. */
export const teamName = (team) => t(`teams.team${team}`);

/** The colour of a team's robots in the arena; undefined for who fights alone. */
export const arenaColour = (team) => ARENA[team - 1];

/** Best first, the members of a team beside each other as far as nobody has another order: for a lobby. */
export const byTeam = (users) => users.toSorted((one, other) => (one.team || MOST_TEAMS + 1) - (other.team || MOST_TEAMS + 1));

/**
 * A result in which the places of teams are counted, not those of fighters; without teams, as it was. Whoever has left a
 * team that still fights has no part in its place.
 * @param {Player[]} result best first
 * @returns {Player[]}
 */
export function standings(result) {
  if (!result.some((entry) => entry.team > 0)) return result;
  const places = [...new Set(result.filter((entry) => !entry.left).map((entry) => entry.place))];
  const placeOf = ({ place }) => (places.includes(place) ? places.indexOf(place) + 1 : places.length + 1);
  return result.map((entry) => ({ ...entry, place: placeOf(entry) }));
}

/** The teams of some players, each once, in their order. */
export const teamsOf = (players) => [...new Set(players.map(({ team }) => team).filter((team) => team > 0))];
