// What has happened between two states of the battle, as the feed tells it. Pure.

import { isSameBattle, newHits, newRefusals } from "./hits.js";
import { UNKNOWN_BATTLE } from "./messages.js";
import { COUNTDOWN, PLAYING, STOPPED } from "./state.js";
import { teamsOf } from "./teams.js";

/** @typedef {import("./messages.js").Status} Status */

/**
 * "hit", "out" and "refused" are of the one who was hit; "fenced" to "double_damage" are ./feed_places.js's.
 * @typedef {object} Change
 * @property {"joined"|"left"|"ready"|"unready"|"countdown"|"cancelled"|"start"|"hit"|"out"|"refused"|"end"|"aborted"|"paused"|"resumed"|"fenced"|"hill"|"repair"|"shield"|"double_damage"} kind
 * @property {string} name of the player; "" if it is nobody's
 * @property {number|null} avatar
 * @property {number|null} life after it
 * @property {number|null} robot
 * @property {{name: string, avatar: number|null, streak: number, revenge: boolean}|null} by the shooter, for "hit", "out" and "refused"; null: the light does not tell
 * @property {string[]} winners who have won, for "end"
 * @property {number[]} teams that have won, for "end"; none: everybody has fought alone
 */

const ofGame = (kind) => ({ kind, name: "", avatar: null, life: null, robot: null, by: null, winners: [], teams: [] });
export const ofPlayer = (kind, { name, avatar, life, robot }) => ({ ...ofGame(kind), name, avatar, life, robot });

/**
 * What has changed, in the order in which people would tell it. States in between may be missing.
 * @param {Status|null} previous null for the first one, after which nothing is news
 * @param {Status} current
 * @returns {Change[]}
 */
export function changes(previous, current) {
  if (!previous) return [];
  return [...ofPeople(previous, current), ...ofPhase(previous, current), ...ofHits(previous, current), ...ofEnd(previous, current)];
}

function ofPeople(previous, current) {
  const before = byName(previous.users);
  const after = byName(current.users);
  const came = current.users.filter((user) => !before.has(user.name)).map((user) => ofPlayer("joined", user));
  const went = previous.users.filter((user) => !after.has(user.name)).map((user) => ofPlayer("left", user));
  if (previous.game === PLAYING || current.game === PLAYING || hasEnded(previous, current)) return [...came, ...went];
  const wishes = current.users
    .filter((user) => user.ready !== (before.get(user.name)?.ready ?? false))
    .map((user) => ofPlayer(user.ready ? "ready" : "unready", user));
  return [...came, ...went, ...wishes];
}

function ofPhase(previous, current) {
  const found = [];
  if (hasStarted(previous, current)) found.push(ofGame("start"));
  else if (current.game === COUNTDOWN && previous.game !== COUNTDOWN) found.push(ofGame("countdown"));
  else if (current.game === STOPPED && previous.game === COUNTDOWN && isSameBattle(previous, current)) found.push(ofGame("cancelled"));
  if (current.paused !== previous.paused && current.game !== STOPPED) found.push(ofGame(current.paused ? "paused" : "resumed"));
  return found;
}

/** The hits that the referee tells, those that do not count, then the lives that are lost without one. */
function ofHits(previous, current) {
  const people = byName([...previous.users, ...current.result, ...current.users]);
  const ofHit = (kind, { name, by, life, streak = 0, revenge = false }) => ({
    ...ofPlayer(kind, { avatar: null, robot: null, ...people.get(name), name, life }),
    by: by ? { name: by, avatar: people.get(by)?.avatar ?? null, streak, revenge } : null,
  });
  const hits = newHits(previous, current).map((hit) => ofHit(hit.life > 0 ? "hit" : "out", hit));
  const refusals = newRefusals(previous, current).map((hit) => ofHit("refused", hit));
  const told = byName(hits);
  return [...hits, ...refusals, ...ofLives(previous, current).filter(({ name }) => !told.has(name))];
}

function ofLives(previous, current) {
  const goesOn = previous.game === PLAYING && isSameBattle(previous, current);
  const isNews = goesOn || hasStarted(previous, current) || !isSameBattle(previous, current);
  if (!isNews) return [];
  const before = byName(goesOn ? previous.users : []);
  return fightersOf(previous, current)
    .filter((fighter) => fighter.life < (before.get(fighter.name)?.life ?? 100))
    .map((fighter) => ofPlayer(fighter.life > 0 ? "hit" : "out", fighter));
}

/** Who fights now, or has fought until just now. */
function fightersOf(previous, current) {
  if (current.game === PLAYING) return current.users.filter((user) => user.ready);
  return hasEnded(previous, current) ? current.result.filter((entry) => !entry.left) : [];
}

function ofEnd(previous, current) {
  if (hasEnded(previous, current)) {
    const won = current.result.filter((entry) => entry.place === 1 && !entry.left);
    return [{ ...ofGame("end"), winners: won.map((entry) => entry.name), teams: teamsOf(won) }];
  }
  // without the referee's reason, the result is still to come
  const isAborted = previous.game === PLAYING && current.game === STOPPED && current.notice !== "";
  return isAborted ? [ofGame("aborted")] : [];
}

function hasStarted(previous, current) {
  return current.game === PLAYING && (previous.game !== PLAYING || !isSameBattle(previous, current));
}

/** Whether the result of a battle is news. */
function hasEnded(previous, current) {
  if (current.game !== STOPPED || current.result.length === 0) return false;
  const wasKnown = previous.battle !== UNKNOWN_BATTLE;
  return previous.game === PLAYING || (wasKnown && (previous.result.length === 0 || !isSameBattle(previous, current)));
}

const byName = (users) => new Map(users.map((user) => [user.name, user]));
