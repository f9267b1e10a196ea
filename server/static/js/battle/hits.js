// Which hits are news, as far as the referee tells each of them: who has shot whom, and which of them do not count. Pure.

import { UNKNOWN_BATTLE } from "./messages.js";

/** @typedef {import("./messages.js").Status} Status */
/** @typedef {import("./messages.js").Hit} Hit */

const REFUSED = 2; // kind of laser_bot_battle/GameEvent

/** Whether two states are of one battle, as far as it is known. */
export const isSameBattle = (one, other) =>
  one.battle === other.battle || [one.battle, other.battle].includes(UNKNOWN_BATTLE);

/**
 * The hits of `current` that have cost life and that `previous` has not told, in their order; states in between may be missing.
 * @param {Status|null} previous null right after the page has been opened: then nothing is news
 * @param {Status} current
 * @returns {Hit[]}
 */
export const newHits = (previous, current) => newEvents(previous, current).filter(({ kind }) => kind !== REFUSED);

/** Likewise those that have not, since the shooter's light cannot have gone there. */
export const newRefusals = (previous, current) => newEvents(previous, current).filter(({ kind }) => kind === REFUSED);

function newEvents(previous, current) {
  if (!previous || !current.events) return [];
  if (!isSameBattle(previous, current)) return current.events;
  if (previous.events) {
    const last = previous.events.at(-1)?.number ?? 0;
    return current.events.filter(({ number }) => number > last);
  }
  // a state without events has told of these hits by the lives that were left
  const lives = new Map(previous.users.map((user) => [user.name, user.life]));
  return current.events.filter(({ name, life }) => life < (lives.get(name) ?? 0));
}

/**
 * What hits mean to one player.
 * @param {Hit[]} hits
 * @param {Status} status the state that tells them
 * @returns {{taken: Hit[], given: Hit[]}} a hit of the own team is not given: it is none to be proud of
 */
export function hitsOf(hits, status, name) {
  const people = new Map([...status.users, ...status.result].map((user) => [user.name, user])); // a result knows the teams better
  const team = people.get(name)?.team ?? 0;
  const isFriend = (other) => team !== 0 && people.get(other)?.team === team;
  return {
    taken: hits.filter((hit) => hit.name === name),
    given: hits.filter((hit) => hit.by === name && hit.name !== name && !isFriend(hit.name)),
  };
}
