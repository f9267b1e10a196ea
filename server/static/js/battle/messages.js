// The state of the battle in one shape, from either of its two sources. Pure.

/**
 * @typedef {object} Player
 * @property {string} name
 * @property {number} robot ID
 * @property {number} life 0 to 100
 * @property {boolean} ready
 * @property {boolean} may_join the battle of others that runs
 * @property {number} fence where the robot may not drive on, since it would leave the floor: 1 ahead, 2 behind, or the sum
 * @property {number} avatar 0 to 4
 * @property {number} place in a result: 1 is the winner, ties share a place
 * @property {number} seat_left s until the robot passes on to others unless the player gets ready; 0: it stays
 * @property {boolean} left in a result: gone before the end
 * @property {number} team 1 to the status's teams; 0: fights alone, or the referee will deal it
 * @property {number} handicap percent of damage that hits do not take from this player
 * @property {number} shots fired in the running or the last battle
 * @property {number} hits of them that have met somebody, as far as the light tells
 * @property {number} kills of them that took the last life
 * @property {number} points s alone on hills in the running or the last battle
 * @property {number} effects of pick-ups, that work now: 1 a shield, 2 double damage, or the sum
 * @property {number} taken in a result: hits of others that cost life
 * @property {number} seconds in a result: in the battle
 * @property {number} wins in a result: battles won in a row, this one included
 * @property {boolean} weak whether the robot has too little voltage
 *
 * @typedef {object} Hit
 * @property {number} number grows from hit to hit
 * @property {0|1|2} kind it has cost life, or the last of it, or, being refused, none
 * @property {string} name who was hit
 * @property {string} by the shooter; empty: the light does not tell
 * @property {number} life that is left
 * @property {number} streak if none is left: how many the shooter has taken out in this battle
 * @property {boolean} revenge if none is left: the shooter had been taken out by this one last
 *
 * @typedef {object} Place
 * @property {0|1|2|3} kind a hill, repair, a shield, double damage
 * @property {number} x m, of its middle
 * @property {number} y m
 * @property {number} radius m
 *
 * @typedef {object} Status
 * @property {0|1|2} game stopped, countdown, playing
 * @property {number} timeLeft s to the start or to the time limit
 * @property {number} protection s for which nobody can be hit; 0: everybody can
 * @property {boolean} paused by the operator: the clock stands
 * @property {string} message the operator's words for all screens; empty without any
 * @property {number} battle number of the battle, or UNKNOWN_BATTLE
 * @property {boolean} practice whether players may drive while it is stopped
 * @property {boolean} practiceBeside whether who is not in the battle may drive while it runs, without shooting
 * @property {number} queue how many people wait for a robot
 * @property {string} notice why the last countdown or battle ended
 * @property {Player[]} users best first
 * @property {Player[]} result the last battle, best first
 * @property {number} teams 2 to 4; 0: everybody fights alone
 * @property {boolean} coded whether the light tells who has shot
 * @property {number} tournament grows with each change of the tournament that is open; 0: none is
 * @property {Place[]} places hills, and what lies on the floor to be picked up
 * @property {Hit[]|null} events the newest of the running or the last battle, the newest last; null: not told
 */

/** The battle's number when only /updateGameStatus has been heard. */
export const UNKNOWN_BATTLE = -1;

const UNTOLD = { may_join: false, fence: 0, team: 0, handicap: 0, shots: 0, hits: 0, kills: 0, points: 0, effects: 0, taken: 0, seconds: 0, wins: 0, weak: false }; // by a server that knows neither teams nor shooters

/** @returns {Status} from a laser_bot_battle/GameStatus of /game_status */
export function fromTopic(message) {
  return {
    game: message.game,
    timeLeft: message.time_left,
    protection: message.protection ?? 0,
    paused: message.paused,
    message: message.message,
    battle: message.battle,
    notice: message.notice,
    practice: message.practice,
    practiceBeside: message.practice_beside ?? false,
    queue: message.queue.length,
    users: message.users.map((user) => ({ ...UNTOLD, ...user })),
    result: message.result.map((entry) => ({ ...UNTOLD, ...entry })),
    teams: message.teams ?? 0,
    coded: message.coded ?? false,
    tournament: message.tournament ?? 0,
    places: message.places ?? [],
    events: message.events ?? null,
  };
}

/**
 * From the reply to POST /updateGameStatus, which knows no pictures, teams and results: those stay as they were.
 * @param {{game: number, timeLeft: number, users: string}} reply `users` is JSON text
 * @param {Status|null} previous
 * @returns {Status}
 */
export function fromReply(reply, previous) {
  const known = new Map(previous?.users.map((user) => [user.name, user]));
  return {
    game: reply.game,
    timeLeft: reply.timeLeft,
    protection: 0,
    paused: previous?.paused ?? false,
    message: previous?.message ?? "",
    battle: previous?.battle ?? UNKNOWN_BATTLE,
    notice: previous?.notice ?? "",
    practice: previous?.practice ?? false,
    practiceBeside: previous?.practiceBeside ?? false,
    queue: previous?.queue ?? 0,
    users: JSON.parse(reply.users).map((user) => ({
      ...UNTOLD,
      avatar: 0,
      ...known.get(user.name),
      name: user.name,
      robot: user.robot,
      life: user.life,
      ready: user.ready === 1,
      place: 0,
      seat_left: 0,
      left: false,
    })),
    result: reply.game === 0 ? (previous?.result ?? []) : [],
    teams: previous?.teams ?? 0,
    coded: previous?.coded ?? false,
    tournament: previous?.tournament ?? 0,
    events: null,
  };
}
